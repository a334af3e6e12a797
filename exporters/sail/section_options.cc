#include <cmath>

#include <fmt/format.h>

#include "exporters/sail/section.h"
#include "importer/base/error.h"
#include "importer/base/numbers.h"

namespace velamap {

OptionGroup DescribeOptions(SectionOptions* options) {
  const auto set_heights = [options](const std::string& text, const std::string& option) {
    const auto heights_m = ParseNumberList<double>(text);
    if (!heights_m) {
      throw InputError(
          fmt::format("{}: '{}' is not a list of heights in m such as 1,2.5,4", option, text));
    }
    options->heights_m = *heights_m;
  };
  return {"Sections",
          {{"Section.heights", ParsedValue{&options->heights_m, "", set_heights}, "m,m,...",
            "heights of sections besides the lines, along the luff from the frame's origin"},
           {"Section.min_markers", &options->min_markers, "markers",
            "minimum number of whole markers on a line for a section", AtLeast(4)}}};
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
      throw InputError(
          fmt::format("{}: {} is not a height; give numbers of metres", name, height_m));
    }
  }
}

}  // namespace velamap
