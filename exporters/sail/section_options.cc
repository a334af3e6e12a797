#include "exporters/sail/section_options.h"

#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/numbers.h"

namespace velamap {
namespace {

std::vector<double> ParseHeights(const std::string& text, const std::string& option) {
  std::vector<double> heights_m;
  std::istringstream stream(text);
  for (std::string item; std::getline(stream, item, ',');) {
    double height_m = 0.0;
    if (!ParseNumber(item, &height_m)) {
      throw InputError(
          fmt::format("{}: '{}' is no list of heights in m such as 1,2.5,4", option, text));
    }
    heights_m.push_back(height_m);
  }
  return heights_m;
}

}  // namespace

OptionGroup DescribeOptions(SectionOptions* options) {
  std::vector<double>* heights_m = &options->heights_m;
  const auto set_heights = [heights_m](const std::string& text, const std::string& option) {
    *heights_m = ParseHeights(text, option);
  };
  return {"Sections",
          {{"Section.heights", ParsedValue{heights_m, "", set_heights}, "m,m,...",
            "heights of sections besides the lines, z of the frame"},
           {"Section.min_markers", &options->min_markers, "markers",
            "fewest whole markers on a line that make a section", AtLeast(4)}}};
}

void SectionOptions::Check() const {
  constexpr std::size_t kMaxHeights = 500;
  CheckRanges(*this);
  const std::string name = OptionName(&SectionOptions::heights_m);
  if (heights_m.size() > kMaxHeights) {
    throw InputError(fmt::format("{}: {} heights are too many; give at most {}", name,
                                 heights_m.size(), kMaxHeights));
  }
  for (const double height_m : heights_m) {
    if (!std::isfinite(height_m)) {
      throw InputError(fmt::format("{}: {} is no height; give numbers of metres", name, height_m));
    }
  }
}

}  // namespace velamap
