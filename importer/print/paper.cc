#include "importer/print/paper.h"

#include <strings.h>

#include <array>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/numbers.h"

namespace velamap {
namespace {

struct NamedPaper {
  const char* name;
  double width_mm, height_mm;
};

constexpr std::array<NamedPaper, 10> kPapers = {{{"A4", 210, 297},
                                                 {"A3", 297, 420},
                                                 {"Letter", 215.9, 279.4},
                                                 {"A0", 841, 1189},
                                                 {"A1", 594, 841},
                                                 {"A2", 420, 594},
                                                 {"A5", 148, 210},
                                                 {"A6", 105, 148},
                                                 {"Legal", 215.9, 355.6},
                                                 {"Tabloid", 279.4, 431.8}}};

bool IsSide(double side_mm) { return side_mm >= kMinPaper_mm && side_mm <= kMaxPaper_mm; }

}  // namespace

Paper ParsePaper(const std::string& text, const std::string& option) {
  for (const NamedPaper& paper : kPapers) {
    if (strcasecmp(text.c_str(), paper.name) == 0)
      return {paper.name, paper.width_mm, paper.height_mm};
  }
  Paper paper{text, 0, 0};
  const std::size_t times = text.find('x');
  if (times == std::string::npos || !ParseNumber(text.substr(0, times), &paper.width_mm) ||
      !ParseNumber(text.substr(times + 1), &paper.height_mm) || !IsSide(paper.width_mm) ||
      !IsSide(paper.height_mm)) {
    throw InputError(
        fmt::format("{}: '{}' is not a paper size; give A4, A3, Letter, A0 to A6, Legal, Tabloid, "
                    "or width x height in mm from {} to {}, such as 330x480",
                    option, text, kMinPaper_mm, kMaxPaper_mm));
  }
  return paper;
}

}  // namespace velamap
