#include "exporters/sail/surface_options.h"

#include <cmath>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

void CheckEdge(const std::vector<Eigen::Vector3d>& edge, const char* name, double extension_m,
               const std::string& extension_option) {
  if (edge.size() == 1) {
    throw InputError(fmt::format("the {} edge has one point; give two or more", name));
  }
  if (!edge.empty() && extension_m > 0) {
    throw InputError(
        fmt::format("{}: the surface cannot go {} m beyond the {} and end at its given edge; give "
                    "one of the two",
                    extension_option, extension_m, name));
  }
}

}  // namespace

OptionGroup DescribeOptions(SurfaceOptions* options) {
  const OptionRange range = FromTo(0, 100);
  return {"Surface",
          {{"Surface.luff_extension", &options->luff_extension_m, "m",
            "how far the surface goes on beyond the first markers of the lines", range},
           {"Surface.leech_extension", &options->leech_extension_m, "m",
            "the same beyond the last markers of the lines", range},
           {"Surface.foot_extension", &options->foot_extension_m, "m",
            "the same below the lowest line", range},
           {"Surface.head_extension", &options->head_extension_m, "m",
            "the same above the highest line", range}}};
}

void SurfaceOptions::Check() const {
  CheckRanges(*this);
  if (default_sigma_m && !(*default_sigma_m >= 0 && std::isfinite(*default_sigma_m))) {
    throw InputError(
        fmt::format("the surface's default sigma is {} m; it must be 0 (interpolate) or more",
                    *default_sigma_m));
  }
  CheckEdge(edges.luff, "luff", luff_extension_m, OptionName(&SurfaceOptions::luff_extension_m));
  CheckEdge(edges.leech, "leech", leech_extension_m,
            OptionName(&SurfaceOptions::leech_extension_m));
  CheckEdge(edges.foot, "foot", foot_extension_m, OptionName(&SurfaceOptions::foot_extension_m));
  CheckEdge(edges.head, "head", head_extension_m, OptionName(&SurfaceOptions::head_extension_m));
}

}  // namespace velamap
