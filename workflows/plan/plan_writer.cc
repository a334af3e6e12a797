#include "workflows/plan/plan_writer.h"

#include <cmath>
#include <map>
#include <ostream>

#include <fmt/format.h>

#include "exporters/shape/shape_sigma.h"
#include "importer/base/statistics.h"
#include "importer/text/csv.h"
#include "workflows/plan/plan_options.h"

namespace velamap {
namespace {

// "1/250 s".
std::string ExposureText(double exposure_s) {
  if (!(exposure_s > 0)) return "none";
  return exposure_s < 0.5 ? fmt::format("1/{:.0f} s", std::ceil(1 / exposure_s))
                          : fmt::format("{:.1f} s", exposure_s);
}

std::string PrecisionText(const PlannedVariant& variant) {
  if (!variant.precision) return "no shape: " + variant.failure;
  const PlanPrecision& precision = *variant.precision;
  return fmt::format("{:>9} {:>11.2g} {:>9.2g} {:>9.3f}", precision.marker_sigma_mm.size(),
                     MedianSigma(precision.marker_sigma_mm),
                     precision.distance_after_scaling_sigma_mm, 100 * precision.scale_sigma);
}

void PrintFacts(const ShootPlan& plan, std::ostream& out) {
  const PlannedPath& path = plan.path;
  out << fmt::format("markers: {} of {:.4g} m\n", plan.surface.shape.markers.size(),
                     plan.surface.layout.marker_length_m);
  out << fmt::format("picture: {} x {} px, focal length {:.0f} px\n", plan.camera.width_px,
                     plan.camera.height_px, MeanFocalLength(plan.camera));
  out << fmt::format("distance_m: {:.4g}\narc_deg: {:.4g}\nviews: {}\n", path.distance_m,
                     path.arc_deg, path.num_views);
  out << fmt::format("side_px: {:.1f} (median along the arc)\n", plan.along_path.median_side_px);
  out << fmt::format("found_percent: {:.0f} (of the markers, in a view)\n",
                     100 * plan.along_path.found_share);
  out << fmt::format("longest_exposure: {} at {:.2g} m/s\n",
                     ExposureText(plan.shutters.front().exposure_s),
                     plan.shutters.front().speed_m_s);
  if (!plan.plan().precision) return;
  const PlanPrecision& precision = *plan.plan().precision;
  out << fmt::format("markers_reconstructed: {}\n", precision.marker_sigma_mm.size());
  out << fmt::format("marker_sigma_mm: {:.2g} (median, size included)\n",
                     MedianSigma(precision.marker_sigma_mm));
  out << fmt::format("distance_sigma_mm: {:.2g}\ndistance_after_scaling_sigma_mm: {:.2g}\n",
                     precision.distance_sigma_mm, precision.distance_after_scaling_sigma_mm);
  out << fmt::format("scale_sigma_percent: {:.3f}\n", 100 * precision.scale_sigma);
}

void PrintViews(const ShootPlan& plan, std::ostream& out) {
  out << fmt::format("\nWhat one view sees (longest_exposure at {:.2g} m/s)\n",
                     plan.shutters.front().speed_m_s);
  out << "distance_m  angle_deg  side_px  in_picture_%  found_%  longest_exposure\n";
  for (const PlannedView& view : plan.views) {
    const ViewSummary& summary = view.summary;
    out << fmt::format("{:>10.4g}  {:>9.0f}  {:>7.1f}  {:>12.0f}  {:>7.0f}  {:>16}\n",
                       view.distance_m, view.angle_deg, summary.median_side_px,
                       100 * summary.in_picture_share, 100 * summary.found_share,
                       ExposureText(view.exposure_s));
  }
}

void PrintShutters(const ShootPlan& plan, std::ostream& out) {
  out << fmt::format("\nHow long the shutter may be open at {:.4g} m\n", plan.path.distance_m);
  out << "speed_m_s  speed_knots  motion_px_s  longest_exposure\n";
  for (const PlannedShutter& shutter : plan.shutters) {
    out << fmt::format("{:>9.2g}  {:>11.2g}  {:>11.0f}  {:>16}\n", shutter.speed_m_s,
                       shutter.speed_m_s / kMPerSPerKnot, shutter.motion_px_s,
                       ExposureText(shutter.exposure_s));
  }
}

void PrintVariants(const ShootPlan& plan, std::ostream& out) {
  out << "\nWhat other paths give (1 sigma; marker_mm contains the size of the print, shape_mm "
         "does "
         "not)\n"
         "changed   distance_m  arc_deg  views    markers   marker_mm  shape_mm   scale_%\n";
  for (const PlannedVariant& variant : plan.variants) {
    out << fmt::format("{:<9} {:>10.4g}  {:>7.0f}  {:>5}  {}\n", variant.changed,
                       variant.path.distance_m, variant.path.arc_deg, variant.path.num_views,
                       PrecisionText(variant));
  }
}

// How a path's views show one marker.
struct MarkerExpectation {
  double num_views = 0.0;
  std::vector<double> sides_px;
};

}  // namespace

std::string RecommendationText(const ShootPlan& plan) {
  if (!plan.recommended) return "none until the problems rated bad above are solved";
  const PlannedPath& path = plan.recommended->path;
  const PlannedShutter& shutter = plan.recommended->shutter;
  const std::string text = fmt::format(
      "go {:.0f} degrees around the markers at {:.4g} m, {} views or more, shutter {} or shorter "
      "at {:.2g} m/s",
      path.arc_deg, path.distance_m, path.num_views, ExposureText(shutter.exposure_s),
      shutter.speed_m_s);
  if (path.arc_deg == plan.path.arc_deg && path.distance_m == plan.path.distance_m) return text;
  return text + fmt::format(
                    " (another path than the planned one: --Plan.arc {:.4g} "
                    "--Plan.distance {:.4g} plans it)",
                    path.arc_deg, path.distance_m);
}

void PrintPlan(const ShootPlan& plan, std::ostream& out) {
  PrintVerdict(JudgePlan(plan), out);
  out << fmt::format("recommendation: {}\n", RecommendationText(plan));
  PrintFacts(plan, out);
  PrintViews(plan, out);
  PrintShutters(plan, out);
  PrintVariants(plan, out);
}

void WritePlanCsv(const ShootPlan& plan, std::ostream& out) {
  CsvWriter csv(out);
  const std::optional<double> none;
  csv.WriteRecord("table", "distance_m", "angle_deg", "arc_deg", "num_views", "speed_m_s",
                  "in_picture", "found", "side_px", "longest_exposure_s", "marker_sigma_mm",
                  "distance_sigma_mm", "distance_after_scaling_sigma_mm", "scale_sigma_percent");
  for (const PlannedView& view : plan.views) {
    csv.WriteRecord("view", view.distance_m, view.angle_deg, none, 1,
                    plan.shutters.front().speed_m_s, view.summary.in_picture_share,
                    view.summary.found_share, view.summary.median_side_px, view.exposure_s, none,
                    none, none, none);
  }
  for (const PlannedShutter& shutter : plan.shutters) {
    csv.WriteRecord("shutter", plan.path.distance_m, none, plan.path.arc_deg, plan.path.num_views,
                    shutter.speed_m_s, none, none, none, shutter.exposure_s, none, none, none,
                    none);
  }
  for (const PlannedVariant& variant : plan.variants) {
    std::optional<double> marker, distance, shape, scale;
    if (variant.precision) {
      marker = MedianSigma(variant.precision->marker_sigma_mm);
      distance = variant.precision->distance_sigma_mm;
      shape = variant.precision->distance_after_scaling_sigma_mm;
      scale = 100 * variant.precision->scale_sigma;
    }
    csv.WriteRecord(variant.changed, variant.path.distance_m, none, variant.path.arc_deg,
                    variant.path.num_views, none, none, none, none, none, marker, distance, shape,
                    scale);
  }
}

void WriteMarkersCsv(const ShootPlan& plan, std::ostream& out) {
  std::map<int, MarkerExpectation> expectations;
  for (const double angle_deg : AnglesOf(plan.path)) {
    const Rigid3 cam_from_plan = CameraAt(plan.surface, plan.path, angle_deg);
    for (const MarkerView& view : SeeMarkers(plan.surface, plan.camera, cam_from_plan)) {
      MarkerExpectation& expectation = expectations[view.marker_id];
      expectation.num_views += view.found_share;
      expectation.sides_px.push_back(view.side_px);
    }
  }
  CsvWriter csv(out);
  csv.WriteRecord("marker_id", "part", "x_m", "y_m", "z_m", "num_views", "side_px", "sigma_mm");
  for (const ShapeMarker& marker : plan.surface.shape.markers) {
    const MarkerExpectation& expectation = expectations[marker.marker_id];
    std::optional<double> side_px, sigma_mm;
    if (!expectation.sides_px.empty()) side_px = Median(expectation.sides_px);
    if (plan.plan().precision) {
      const auto& sigmas_mm = plan.plan().precision->marker_sigma_mm;
      const auto found = sigmas_mm.find(marker.marker_id);
      if (found != sigmas_mm.end()) sigma_mm = found->second;
    }
    const Eigen::Vector3d& x = *marker.x_in_shape_m[0];
    csv.WriteRecord(marker.marker_id, marker.part, x.x(), x.y(), x.z(), expectation.num_views,
                    side_px, sigma_mm);
  }
}

}  // namespace velamap
