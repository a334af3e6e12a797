#include "workflows/plan/plan_options.h"

#include <cmath>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {

OptionGroup DescribeOptions(ShootPlanOptions* options) {
  return {
      "Plan",
      {Common({"field_of_view", &options->field_of_view_deg, "deg",
               "angle from the left border of the picture to the right; replaces --camera_path",
               FromTo(0.1, 200)}),
       Common(ChoiceOption(
           "lens", &options->lens, {{LensMode::kLinear, "linear"}, {LensMode::kWide, "wide"}},
           "with --field_of_view: linear keeps straight lines straight; wide bends them, "
           "as an action camera does")),
       Common({"width", &options->width_px, "px", "width of the picture, with --field_of_view",
               FromTo(320, 20000)}),
       Common({"height", &options->height_px, "px", "height of the picture, with --field_of_view",
               FromTo(240, 20000)}),
       Common({"Plan.distance", &options->distance_m, "m",
               "distance of the camera from the middle of the markers; left out: as close as "
               "they fit into the picture",
               FromTo(0.01, 10000)}),
       {"Plan.arc", &options->arc_deg, "deg", "angle by which the camera moves around the markers",
        FromTo(0, 160)},
       {"Plan.height", &options->height_m, "m",
        "height of the camera over the lowest marker; left out: 1, or the middle of the markers if "
        "that is lower",
        FromTo(-100, 1000)},
       {"Plan.num_views", &options->num_views, "frames",
        "views that the adjustment uses, evenly along the arc", FromTo(2, 400)},
       {"Plan.speed", &options->speed_m_s, "m/s",
        "speed of the camera relative to the markers; left out: 1", FromTo(0, 100)},
       Common({"Plan.speed_knots", &options->speed_knots, "knots", "replaces --Plan.speed",
               FromTo(0, 200)}),
       {"Plan.turn_rate", &options->turn_rate_deg_s, "deg/s",
        "rotation of the camera, by hand and waves, while the shutter is open", FromTo(0, 1000)},
       {"Plan.corner_sigma", &options->corner_sigma_px, "px",
        "1 sigma of a corner's coordinate on a marker of 20 px", FromTo(0.001, 5)},
       {"Plan.camber", &options->camber, "fraction", "depth of the planned sail over its chord",
        FromTo(0, 0.4)},
       {"Plan.twist", &options->twist_deg, "deg", "twist of the planned sail, from foot to head",
        FromTo(-60, 60)}}};
}

void ShootPlanOptions::Check() const {
  CheckRanges(*this);
  if (speed_m_s && speed_knots) {
    throw InputError(
        "--Plan.speed_knots: --Plan.speed gives the speed already; leave one of the two out");
  }
}

double ShootPlanOptions::SpeedInMPerS() const {
  return speed_knots ? kMPerSPerKnot * *speed_knots : speed_m_s.value_or(1.0);
}

Camera CameraOfFieldOfView(const ShootPlanOptions& options) {
  if (!options.field_of_view_deg) {
    throw InputError(
        "--camera_path: missing; give a calibration file, or --field_of_view with --width and "
        "--height of the picture");
  }
  const double half_rad = 0.5 * kRadPerDeg * *options.field_of_view_deg;
  const double half_px = 0.5 * options.width_px;
  Camera camera{CameraModel::kPinhole, options.width_px, options.height_px, {}};
  if (options.lens == LensMode::kLinear) {
    constexpr double kMaxLinearView_deg = 150.0;
    if (*options.field_of_view_deg > kMaxLinearView_deg) {
      throw InputError(
          fmt::format("--field_of_view: {} degrees need a lens that bends lines; give --lens wide",
                      *options.field_of_view_deg));
    }
    const double focal_px = half_px / std::tan(half_rad);
    camera.params = {focal_px, focal_px, half_px, 0.5 * options.height_px};
  } else {
    const double focal_px = half_px / half_rad;
    camera.model = CameraModel::kOpenCVFisheye;
    camera.params = {focal_px, focal_px, half_px, 0.5 * options.height_px, 0, 0, 0, 0};
  }
  return camera;
}

}  // namespace velamap
