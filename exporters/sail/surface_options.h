// Options of the surface, surface.h.

#pragma once

#include <optional>

#include "exporters/sail/surface_input.h"
#include "importer/base/option.h"

namespace velamap {

struct SurfaceOptions {
  // 1 sigma of markers without one of their own. Nothing: the median of the others; where no marker
  // has one, cross-validation finds the noise (with 30 markers or more; fewer are interpolated).
  // 0: the surface passes through all markers.
  std::optional<double> default_sigma_m;
  // How far the surface goes on beyond the outer markers, with the curvature that it has there.
  double luff_extension_m = 0.0;
  double leech_extension_m = 0.0;
  double foot_extension_m = 0.0;
  double head_extension_m = 0.0;
  // Edges that it goes on to instead.
  SurfaceEdges edges;

  // Throws InputError that names the option: a value beyond its range, a negative sigma, an edge of
  // one point, an edge that is both given and extended.
  void Check() const;
};

OptionGroup DescribeOptions(SurfaceOptions* options);

}  // namespace velamap
