#include "workflows/plan/shoot_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

// The least that a view has to show for its pose to be trusted.
constexpr double kMinMarkersOfView = 4.0;
constexpr double kUsualHeight_m = 1.0;  // of a hand in a boat over a sail's foot

ViewSummary SummarizePath(const PlannedSurface& surface, const Camera& camera,
                          const PlannedPath& path) {
  std::vector<std::vector<MarkerView>> views;
  for (const double angle_deg : AnglesOf(path)) {
    views.push_back(SeeMarkers(surface, camera, CameraAt(surface, path, angle_deg)));
  }
  return Summarize(surface, views);
}

ViewSummary SummarizeView(const PlannedSurface& surface, const Camera& camera,
                          const PlannedPath& path, double angle_deg) {
  return Summarize(surface, {SeeMarkers(surface, camera, CameraAt(surface, path, angle_deg))});
}

double NumFound(const PlannedSurface& surface, const ViewSummary& summary) {
  return summary.found_share * static_cast<double>(surface.shape.markers.size());
}

// Markers in a view from which its pose can be found, if there are as many.
double NumNeeded(const PlannedSurface& surface) {
  return std::min(kMinMarkersOfView, static_cast<double>(surface.shape.markers.size()));
}

// To two digits.
double Rounded(double value) {
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return step * std::round(value / step);
}

// Whether no view of the path leaves out a marker whose face it would show.
bool HoldsAllMarkers(const PlannedSurface& surface, const Camera& camera, const PlannedPath& path) {
  const std::vector<double> angles_deg = AnglesOf(path);
  return std::all_of(angles_deg.begin(), angles_deg.end(), [&](double angle_deg) {
    return MarkersOutsidePicture(surface, camera, CameraAt(surface, path, angle_deg)).empty();
  });
}

// The nearest distance at which all markers are in the picture and nearly as many are found along
// the arc as at the best such distance. If the markers are far too small from there, the sail has
// to be filmed in parts, and the best of all distances is taken.
double ChooseDistance(const PlannedSurface& surface, const Camera& camera, PlannedPath path) {
  constexpr double kNearest = 0.3, kFarthest = 60.0, kStep = 1.08, kNearlyAll = 0.98;
  constexpr double kFarTooFew = 0.5;  // of those that the best distance finds
  const int num_views = path.num_views;
  double extent_m = 0.0;
  for (const ShapeMarker& marker : surface.shape.markers) {
    extent_m = std::max(
        {extent_m, marker.x_in_shape_m[0]->norm(), MarkerLength(surface.layout, marker.marker_id)});
  }
  path.num_views = std::min(path.num_views, 9);
  std::vector<std::pair<double, double>> distance_and_found;
  double most = 0.0;
  for (double factor = kNearest; factor < kFarthest; factor *= kStep) {
    path.distance_m = Rounded(factor * extent_m);
    const double found = SummarizePath(surface, camera, path).found_share;
    distance_and_found.emplace_back(path.distance_m, found);
    most = std::max(most, found);
  }
  if (most * static_cast<double>(surface.shape.markers.size()) < 0.5 * NumNeeded(surface)) {
    throw InputError(
        "--marker_length: at no distance does the picture hold enough markers that are large "
        "enough to be found; give larger or fewer markers, or a camera with more pixels");
  }
  const auto found_is_less = [](const auto& a, const auto& b) { return a.second < b.second; };
  path.num_views = num_views;
  auto begin =
      std::find_if(distance_and_found.begin(), distance_and_found.end(), [&](const auto& entry) {
        path.distance_m = entry.first;
        return HoldsAllMarkers(surface, camera, path);
      });
  const auto end = distance_and_found.end();
  auto best = std::max_element(begin, end, found_is_less);
  if (best == end || best->second < kFarTooFew * most) {
    begin = distance_and_found.begin();
    best = std::max_element(begin, end, found_is_less);
  }
  return std::find_if(begin, end,
                      [&](const auto& entry) { return entry.second >= kNearlyAll * best->second; })
      ->first;
}

void CheckGivenDistance(const PlannedSurface& surface, const Camera& camera,
                        const PlannedPath& path, const ViewSummary& summary) {
  const double num_found = NumFound(surface, summary);
  if (num_found >= kMinMarkersOfView || summary.found_share > 0.5) return;
  const ViewSummary ahead = SummarizeView(surface, camera, path, 0.0);
  throw InputError(fmt::format(
      "--Plan.distance: from {} m {:.1f} of {} markers are found in a view (from straight ahead, "
      "{:.0f} % are in the picture, {:.1f} px wide where {:.0f} px are needed); give such as {} m",
      path.distance_m, num_found, surface.shape.markers.size(), 100 * ahead.in_picture_share,
      ahead.median_side_px, NarrowPxForHalf(surface.num_cells),
      ChooseDistance(surface, camera, path)));
}

// Pixels per second, for a camera that does not follow what it films.
double MotionPxPerS(const Camera& camera, double distance_m, double speed_m_s,
                    double turn_rate_deg_s) {
  return MeanFocalLength(camera) * (speed_m_s / distance_m + kRadPerDeg * turn_rate_deg_s);
}

double LongestExposure(const PlannedSurface& surface, double narrow_px, double motion_px_s) {
  constexpr double kLongest_s = 1.0;
  const double path_px = ToleratedMotionPx(narrow_px, surface.num_cells);
  return path_px < kLongest_s * motion_px_s ? path_px / motion_px_s : kLongest_s;
}

// The narrow side of the markers in the view of the path that shows them narrowest: an end of the
// arc, which the shutter has to suit as well. Views without enough markers for a pose do not count,
// as they add nothing to the shape.
double NarrowestAlongPath(const ShootPlan& plan) {
  std::optional<double> narrowest_px;
  for (const double angle_deg : AnglesOf(plan.path)) {
    const ViewSummary view = SummarizeView(plan.surface, plan.camera, plan.path, angle_deg);
    if (NumFound(plan.surface, view) < 0.5 * NumNeeded(plan.surface)) continue;
    narrowest_px = std::min(narrowest_px.value_or(view.median_narrow_px), view.median_narrow_px);
  }
  return narrowest_px.value_or(plan.along_path.median_narrow_px);
}

PlannedVariant MakeVariant(const std::string& changed, const PlannedPath& path,
                           const PlannedSurface& surface, const Camera& camera,
                           const ShootPlanOptions& options) {
  PlannedVariant variant{changed, path, std::nullopt, ""};
  try {
    variant.precision = SimulatePlan(surface, camera, path, options);
  } catch (const DataError& error) {
    variant.failure = error.what();
  }
  return variant;
}

void AddVariants(const ShootPlanOptions& options, const ProgressCallback& progress,
                 ShootPlan* plan) {
  std::vector<std::pair<std::string, PlannedPath>> paths;
  const auto add = [&](const std::string& changed, auto PlannedPath::*member, auto value) {
    paths.emplace_back(changed, plan->path);
    paths.back().second.*member = value;
  };
  for (const int num_views : {5, 10, 20, 40, 80}) add("views", &PlannedPath::num_views, num_views);
  for (const double arc_deg : {10.0, 20.0, 40.0, 60.0, 90.0, 120.0}) {
    add("arc", &PlannedPath::arc_deg, arc_deg);
  }
  for (const double factor : {0.7, 1.5, 2.0}) {
    add("distance", &PlannedPath::distance_m, Rounded(factor * plan->path.distance_m));
  }
  const auto num_paths = static_cast<int>(paths.size());
  if (progress) progress(0, num_paths, "");
  int num_done = 0;
  for (const auto& [changed, path] : paths) {
    plan->variants.push_back(MakeVariant(changed, path, plan->surface, plan->camera, options));
    if (progress) progress(++num_done, num_paths, "");
  }
}

void AddViews(const ShootPlanOptions& options, ShootPlan* plan) {
  for (const double factor : {0.5, 0.7, 1.0, 1.5, 2.0, 3.0}) {
    for (const double angle_deg : {0.0, 30.0, 60.0}) {
      PlannedPath from = plan->path;
      from.distance_m = factor == 1 ? plan->path.distance_m : Rounded(factor * from.distance_m);
      PlannedView view{from.distance_m, angle_deg,
                       SummarizeView(plan->surface, plan->camera, from, angle_deg), 0.0};
      view.exposure_s =
          LongestExposure(plan->surface, view.summary.median_narrow_px,
                          MotionPxPerS(plan->camera, from.distance_m, options.SpeedInMPerS(),
                                       options.turn_rate_deg_s));
      plan->views.push_back(view);
    }
  }
}

// The plan of one path, without what other places and paths give.
ShootPlan PlanPath(const PlannedSurface& surface, const Camera& camera, const PlannedPath& path,
                   const ShootPlanOptions& options) {
  ShootPlan plan;
  plan.camera = camera;
  plan.surface = surface;
  plan.path = path;
  plan.along_path = SummarizePath(surface, camera, path);
  const double narrow_px = NarrowestAlongPath(plan);
  for (const double factor : {1.0, 0.5, 2.0}) {
    PlannedShutter shutter{factor * options.SpeedInMPerS(), 0.0, 0.0};
    shutter.motion_px_s =
        MotionPxPerS(camera, path.distance_m, shutter.speed_m_s, options.turn_rate_deg_s);
    shutter.exposure_s = LongestExposure(surface, narrow_px, shutter.motion_px_s);
    plan.shutters.push_back(shutter);
  }
  plan.variants = {MakeVariant("plan", path, surface, camera, options)};
  return plan;
}

// The planned path unless it is bad; else the usual arc from the distance that suits it, unless
// that is bad too.
std::optional<PlannedRecommendation> Recommend(const ShootPlan& plan,
                                               const ShootPlanOptions& options) {
  if (JudgePlan(plan).level != ReportStatus::kBad) {
    return PlannedRecommendation{plan.path, plan.shutters.front()};
  }
  const ShootPlanOptions usual;
  PlannedPath path = plan.path;
  path.arc_deg = usual.arc_deg;
  path.num_views = std::max(path.num_views, usual.num_views);
  try {
    path.distance_m = ChooseDistance(plan.surface, plan.camera, path);
  } catch (const InputError&) {
    return std::nullopt;  // no distance suits these markers
  }
  const ShootPlan other = PlanPath(plan.surface, plan.camera, path, options);
  if (JudgePlan(other).level == ReportStatus::kBad) return std::nullopt;
  return PlannedRecommendation{path, other.shutters.front()};
}

}  // namespace

ShootPlan MakeShootPlan(const PlannedSurface& surface, const Camera& camera,
                        const ShootPlanOptions& options, const ProgressCallback& progress) {
  PlannedPath path{0.0, options.arc_deg,
                   options.height_m.value_or(std::min(kUsualHeight_m, LowestDepth(surface))),
                   options.num_views};
  path.distance_m =
      options.distance_m ? *options.distance_m : ChooseDistance(surface, camera, path);
  CheckGivenDistance(surface, camera, path, SummarizePath(surface, camera, path));
  ShootPlan plan = PlanPath(surface, camera, path, options);
  plan.recommended = Recommend(plan, options);
  AddViews(options, &plan);
  AddVariants(options, progress, &plan);
  return plan;
}

}  // namespace velamap
