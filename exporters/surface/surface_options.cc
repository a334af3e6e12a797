#include "exporters/surface/surface.h"

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

void CheckEdge(const std::vector<Eigen::Vector3d>& edge, const char* name,
               const std::optional<double>& extension_mm, const std::string& extension_option) {
  if (edge.size() == 1) {
    throw InputError(fmt::format("the {} edge has one point; it needs two or more", name));
  }
  if (!edge.empty() && extension_mm.value_or(0.0) > 0) {
    throw InputError(
        fmt::format("{}: the surface cannot go {} mm beyond the {} and end at its given edge; give "
                    "one of the two",
                    extension_option, *extension_mm, name));
  }
}

}  // namespace

OptionGroup DescribeOptions(SurfaceOptions* options) {
  return {"Surface",
          {{"Surface.luff_extension", &options->luff_extension_mm, "mm",
            "how far the surface continues beyond the first markers of the lines; left out: to the "
            "edge that the layout names, or not at all",
            AtLeast(0)},
           {"Surface.leech_extension", &options->leech_extension_mm, "mm",
            "the same beyond the last markers of the lines", AtLeast(0)},
           {"Surface.foot_extension", &options->foot_extension_mm, "mm",
            "the same below the lowest line", AtLeast(0)},
           {"Surface.head_extension", &options->head_extension_mm, "mm",
            "the same above the highest line", AtLeast(0)}}};
}

void SurfaceOptions::Check() const {
  CheckRanges(*this);
  CheckEdge(edges.luff.points_m, "luff", luff_extension_mm,
            OptionName(&SurfaceOptions::luff_extension_mm));
  CheckEdge(edges.leech.points_m, "leech", leech_extension_mm,
            OptionName(&SurfaceOptions::leech_extension_mm));
  CheckEdge(edges.foot.points_m, "foot", foot_extension_mm,
            OptionName(&SurfaceOptions::foot_extension_mm));
  CheckEdge(edges.head.points_m, "head", head_extension_mm,
            OptionName(&SurfaceOptions::head_extension_mm));
}

}  // namespace velamap
