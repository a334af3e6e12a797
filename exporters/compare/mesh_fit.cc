#include "exporters/compare/mesh_fit.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "exporters/compare/closest_points.h"
#include "exporters/compare/comparison_sigma.h"
#include "exporters/shape/common_corners.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kAlsoFits = 1.2;       // largest ratio of the costs of poses that fit equally well
constexpr double kOtherPose_rad = 0.1;  // least rotation between different poses

void AddNotes(const std::vector<SurfacePose>& fits, double zero_m, Alignment* alignment) {
  const SurfacePose& best = fits.front();
  if (!best.has_converged) {
    alignment->notes.push_back(
        fmt::format("the fit did not converge in {} iterations, the last of which moved the shape "
                    "by {:.2g} mm; if that matters, move the shape closer to the surface and give "
                    "--align_start as_is",
                    kMaxFitIterations, kMmPerM * best.last_step_m));
  }
  const int num_free = AlignmentSensitivity(*alignment).NumFreeDirections();
  if (num_free > 0) {
    alignment->notes.push_back(
        fmt::format("the surface does not determine {} of 6 rigid motions (like a plane, a "
                    "sphere or a cylinder); distances along them are arbitrary",
                    num_free));
  }
  for (const SurfacePose& fit : fits) {
    const double angle = AngularDistance(fit.pose, best.pose);
    if (angle < kOtherPose_rad || fit.trimmed_rms_m > kAlsoFits * best.trimmed_rms_m + zero_m) {
      continue;
    }
    alignment->notes.push_back(
        fmt::format("a pose rotated by {:.0f} degrees fits equally well; to choose one, move the "
                    "shape close to it and give --align_start as_is",
                    kDegPerRad * angle));
    return;
  }
}

Alignment DescribeFit(const std::vector<SurfacePose>& fits, const CommonCorners& corners,
                      const MeshDistance& mesh) {
  Alignment alignment;
  alignment.method = AlignmentMethod::kBestFit;
  alignment.reference_from_shape = fits.front().pose;
  const std::vector<PointResidual> residuals =
      ComputeResiduals(corners.x_in_shape_m, fits.front().pose, mesh);
  if (!EnoughOverSurface(residuals)) {
    throw DataError(
        "the best fit has fewer than six corners over the surface of the reference; give a surface "
        "that covers the markers, or align both by hand and give --align none");
  }
  const double zero_m = ZeroDistance_m(mesh);
  const std::vector<double> weights = TukeyWeights(residuals, zero_m);
  std::vector<double> used_m;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (weights[i] <= 0) continue;
    used_m.push_back(std::abs(residuals[i].distance_m));
    alignment.equations.push_back(
        {corners.ids[i], residuals[i].x_m, residuals[i].direction, weights[i]});
  }
  alignment.description =
      fmt::format("onto the surface, {} of {} corners", used_m.size(), residuals.size());
  alignment.residual_m = ComputeStatistics(std::move(used_m));
  AddNotes(fits, zero_m, &alignment);
  return alignment;
}

}  // namespace

Alignment AlignToMesh(const MarkerShape& shape, const MeshDistance& mesh,
                      const AlignmentOptions& options) {
  if (options.method == AlignmentMethod::kNone) return NoAlignment();
  if (options.method != AlignmentMethod::kAuto && options.method != AlignmentMethod::kBestFit) {
    throw InputError(
        fmt::format("--align {}: the reference is a surface without markers; give best_fit or none",
                    AlignmentMethodName(options.method)));
  }
  const CommonCorners corners = FindCommonCorners(shape, shape);  // all
  if (corners.ids.size() < kMinPointsOverSurface) {
    throw DataError(
        fmt::format("{} marker corners are too few for a best fit to a surface, which needs {}",
                    corners.ids.size(), kMinPointsOverSurface));
  }
  return DescribeFit(FitToSurface(corners.x_in_shape_m, mesh, options.starts_as_is), corners, mesh);
}

}  // namespace velamap
