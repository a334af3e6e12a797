// The options of a plan of a shoot.

#pragma once

#include <cstdint>
#include <optional>

#include "importer/base/option.h"
#include "importer/camera/camera.h"

namespace velamap {

inline constexpr double kMPerSPerKnot = 1852.0 / 3600.0;

enum class LensMode {
  kLinear,  // straight lines stay straight
  kWide,    // an action camera's: angles in proportion to the distance from the picture's middle
};

struct ShootPlanOptions {
  // The camera without a calibration.
  std::optional<double> field_of_view_deg;  // from the left border of the picture to the right
  LensMode lens = LensMode::kLinear;
  int width_px = 1920, height_px = 1080;

  // The camera's path: on an arc around the middle of the markers, which it looks at.
  std::optional<double> distance_m;  // nothing: as close as they fit into the picture
  double arc_deg = 90.0;             // from the first view to the last
  // Height of the camera over the lowest marker; nothing: 1 m, or the middle of the markers if that
  // is lower.
  std::optional<double> height_m;
  int num_views = 40;  // that the adjustment uses

  std::optional<double> speed_m_s;  // of the camera relative to the surface; nothing: 1
  std::optional<double> speed_knots;
  double turn_rate_deg_s = 10.0;

  // 1 sigma of a corner's coordinate on a marker of 20 px, including errors that neighbouring
  // frames share: two thirds more than single corners of rendered clips of an action camera have
  // (workflows/studies/shooting.sh).
  double corner_sigma_px = 0.075;

  // The shape of a sail for which none is given.
  double camber = 0.1;  // depth / chord
  double twist_deg = 10.0;

  std::uint32_t seed = 0;
  int num_threads = 0;  // 0: one per core; never changes the result

  void Check() const;  // throws InputError that names the option

  double SpeedInMPerS() const;
};

OptionGroup DescribeOptions(ShootPlanOptions* options);

// Throws InputError without a field of view, and for one that the lens cannot have.
Camera CameraOfFieldOfView(const ShootPlanOptions& options);

}  // namespace velamap
