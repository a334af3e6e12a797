#include <map>

#include <fmt/format.h>

#include "importer/text/id_ranges.h"
#include "workflows/check/clip_limits.h"
#include "workflows/plan/shoot_plan.h"

namespace velamap {
namespace {

constexpr double kGoodShare = 0.8, kBadShare = 0.5;

std::string PercentText(double share) { return fmt::format("{:.0f} %", 100 * share); }

// The number of views of a path that show a marker, and of those that look past it.
struct Sightings {
  std::map<int, int> num_inside, num_outside;  // by marker

  // The share of all markers in all views that lie outside the picture.
  double OutsideShare(const PlannedSurface& surface, const PlannedPath& path) const {
    int num = 0;
    for (const auto& [marker_id, num_views] : num_outside) num += num_views;
    const double num_possible =
        static_cast<double>(surface.shape.markers.size()) * static_cast<double>(path.num_views);
    return num_possible > 0 ? num / num_possible : 0.0;
  }
};

Sightings CountSightings(const ShootPlan& plan, const PlannedPath& path) {
  Sightings sightings;
  for (const double angle_deg : AnglesOf(path)) {
    const Rigid3 cam_from_plan = CameraAt(plan.surface, path, angle_deg);
    for (const MarkerView& view : SeeMarkers(plan.surface, plan.camera, cam_from_plan)) {
      ++sightings.num_inside[view.marker_id];
    }
    for (const int marker_id : MarkersOutsidePicture(plan.surface, plan.camera, cam_from_plan)) {
      ++sightings.num_outside[marker_id];
    }
  }
  return sightings;
}

// What to do about markers that are too small. They would be larger from closer by, which does not
// help if they leave the picture.
std::string RemedyForSmallMarkers(const ShootPlan& plan, double outside_share) {
  constexpr double kCloser = 0.8, kHardlyMore = 0.01;
  PlannedPath closer = plan.path;
  closer.distance_m *= kCloser;
  const bool stay_in_picture =
      CountSightings(plan, closer).OutsideShare(plan.surface, closer) < outside_share + kHardlyMore;
  return std::string(stay_in_picture ? "go closer, " : "") +
         "film with more pixels, or print larger markers";
}

// The markers that the adjustment does not reach, sorted by cause, because each has its own remedy.
void JudgeMissingMarkers(const ShootPlan& plan, const Sightings& sightings,
                         const std::string& remedy_for_small, VerdictReasons* reasons) {
  const auto number_of = [](const std::map<int, int>& numbers, int marker_id) {
    const auto found = numbers.find(marker_id);
    return found == numbers.end() ? 0 : found->second;
  };
  std::vector<int> outside, small, turned_away;
  for (const ShapeMarker& marker : plan.surface.shape.markers) {
    const int marker_id = marker.marker_id;
    if (plan.plan().precision->marker_sigma_mm.count(marker_id) > 0) continue;
    const int num_inside = number_of(sightings.num_inside, marker_id);
    if (number_of(sightings.num_outside, marker_id) > num_inside) {
      outside.push_back(marker_id);
    } else {
      (num_inside > 0 ? small : turned_away).push_back(marker_id);
    }
  }
  const auto add = [&](const std::vector<int>& marker_ids, const std::string& cause,
                       const std::string& remedy) {
    if (marker_ids.empty()) return;
    reasons->Check(fmt::format("found in fewer than two views, because they are {}: {}: {}", cause,
                               IdRanges(marker_ids), remedy));
  };
  add(outside, "outside the picture", "go farther away or use a wider lens");
  add(small, "too small", remedy_for_small);
  add(turned_away, "turned away from the camera", "film from the side that they face as well");
}

}  // namespace

Verdict JudgePlan(const ShootPlan& plan) {
  constexpr double kShortest_s = 1.0 / 4000;
  VerdictReasons reasons;
  const auto judge = [&](double value, double good, double bad, const std::string& text) {
    if (value < good) reasons.Add(value < bad ? ReportStatus::kBad : ReportStatus::kCheck, text);
  };
  const PlannedVariant& planned = plan.plan();
  if (!planned.precision) reasons.Bad("these views give no shape: " + planned.failure);
  const Sightings sightings = CountSightings(plan, plan.path);
  const double outside_share = sightings.OutsideShare(plan.surface, plan.path);
  const std::string remedy_for_small = RemedyForSmallMarkers(plan, outside_share);
  judge(plan.along_path.found_share, kGoodShare, kBadShare,
        fmt::format(
            "a view finds {} of the markers, {} are in the picture: {}",
            PercentText(plan.along_path.found_share), PercentText(plan.along_path.in_picture_share),
            outside_share > 1 - kGoodShare ? "go farther away, use a wider lens, or film in parts"
                                           : remedy_for_small));
  judge(plan.along_path.median_side_px, kGoodSidePx, kBadSidePx,
        fmt::format("half of the markers are smaller than {:.0f} px: {}",
                    plan.along_path.median_side_px, remedy_for_small));
  judge(plan.path.arc_deg, kGoodParallax_deg, kBadParallax_deg,
        fmt::format("the camera moves only {:.0f} degrees around the markers, which hardly "
                    "determines depth: plan a larger arc",
                    plan.path.arc_deg));
  if (plan.shutters.front().exposure_s < kShortest_s) {
    reasons.Check("few cameras have such a short exposure: go slower, or hold the camera steadier");
  }
  if (!plan.surface.markers_left_out.empty()) {
    reasons.Check(fmt::format(
        plan.surface.is_of_shape
            ? "not planned, because the shape does not hold them: {}: give a shape with all markers"
            : "not planned, because the layout does not say where they are: {}: give --shape_path",
        IdRanges(plan.surface.markers_left_out)));
  }
  if (planned.precision) {
    JudgeMissingMarkers(plan, sightings, remedy_for_small, &reasons);
    for (const std::string& warning : planned.precision->warnings) reasons.Check(warning);
  }
  return reasons.Take();
}

}  // namespace velamap
