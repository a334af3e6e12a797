#include "reconstruct/map/map_verdict.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "importer/base/statistics.h"
#include "importer/geometry/pose_step.h"
#include "importer/geometry/quad.h"
#include "importer/geometry/symmetric_eigen.h"
#include "reconstruct/map/map_refinement.h"
#include "reconstruct/model/moved_views.h"

namespace velamap {
namespace {

// Converts a median RMS error of four corners to 1 sigma of a coordinate.
double SigmaFromMedian(double median_rms, double median_of_chi_square) {
  return median_rms * std::sqrt(kNumCorners / median_of_chi_square);
}

std::string Px(double value) { return fmt::format("{:.{}f} px", value, value < 10 ? 1 : 0); }

// From the corners to their projections, px.
std::array<Eigen::Vector2d, kNumCorners> CornerErrorsPx(const MapProblem& problem,
                                                        const MapSolution& solution,
                                                        const MapObservation& observation) {
  const Rigid3& pose = *solution.Pose(observation.frame_idx);
  const auto corners = CornersInShape(problem.Marker(observation.marker_idx),
                                      solution.Places(observation.marker_idx).front());
  std::array<Eigen::Vector2d, kNumCorners> errors_px;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    errors_px[i] =
        observation.px_from_ray[i] * ((pose * corners[i]).hnormalized() - observation.rays[i]);
  }
  return errors_px;
}

// A marker as a frame should show it: the width across its shorter direction, px. Returns nothing
// if it is turned away, or not completely in the image with the margin of half its width that
// detection needs.
std::optional<double> ShownWidth(const MapFrame& frame, const Rigid3& cam_from_shape,
                                 const std::array<Eigen::Vector3d, kNumCorners>& corners) {
  const Eigen::Vector3d normal = (corners[0] - corners[1]).cross(corners[2] - corners[1]);
  const Eigen::Vector3d center_in_shape =
      (corners[0] + corners[1] + corners[2] + corners[3]) / kNumCorners;
  if ((cam_from_shape * center_in_shape).dot(cam_from_shape.rotation * normal) >= 0) {
    return std::nullopt;
  }
  QuadCorners quad;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const auto image_px = ImageFromCam(*frame.camera, cam_from_shape * corners[i]);
    if (!image_px) return std::nullopt;
    quad[i] = *image_px;
  }
  const double diagonal_px = std::max((quad[2] - quad[0]).norm(), (quad[3] - quad[1]).norm());
  const double width_px = QuadArea(quad) / diagonal_px;
  const Eigen::Array2d size_px(frame.camera->width_px, frame.camera->height_px);
  for (const Eigen::Vector2d& corner : quad) {
    if ((corner.array() < 0.5 * width_px).any() ||
        (corner.array() > size_px - 0.5 * width_px).any()) {
      return std::nullopt;
    }
  }
  return width_px;
}

// 1 sigma of the centre in its least certain direction, for fixed frames. The errors of the four
// corners in one view are taken as one error: those of the pose, the lens and the cloth move them
// together, and sigma_px does not contain them. With independent errors, half of this sigma would
// be enough. If the frames look from one side, the distance follows from the marker's size in
// the image. The error of its print is the same fraction in all frames: one unknown with a prior,
// which is eliminated. However many frames look from one side, the distance is no more certain than
// the print.
double CenterSigma(const MapProblem& problem, const MapSolution& solution, const MapNoise& noise,
                   int marker_idx) {
  const MapMarker& marker = problem.Marker(marker_idx);
  const Sim3& place = solution.Places(marker_idx).front();
  const double factor = std::max(noise.factor, kMinNoiseFactor);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d with_side = Eigen::Vector3d::Zero();
  double of_side = 1 / (kScaleSigma * kScaleSigma);
  for (const int idx : marker.observation_idxs) {
    if (!solution.IsInlier(idx)) continue;
    const MapObservation& observation = problem.Observation(idx);
    const Rigid3& pose = *solution.Pose(observation.frame_idx);
    const Eigen::Vector3d x = pose * place.translation;
    const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
    const double sigma_px = factor * observation.sigma_px;
    const Eigen::Matrix<double, 2, 3> jacobian =
        observation.px_from_ray[0] * RayByPoint(x) * rotation / sigma_px;
    // log(size in the image) = log(side) - log(distance).
    const Eigen::Vector3d log_distance_by_x = rotation.transpose() * x / x.squaredNorm();
    const double size_weight = std::pow(observation.side_px / sigma_px, 2);
    information += jacobian.transpose() * jacobian +
                   size_weight * log_distance_by_x * log_distance_by_x.transpose();
    with_side += size_weight * log_distance_by_x;
    of_side += size_weight;
  }
  const Eigen::Matrix3d of_center = information - with_side * with_side.transpose() / of_side;
  return 1 / std::sqrt(DecomposeSymmetric(of_center).values[0]);
}

// MapNoise::factor_of_marker. Views beyond the tolerance of a growing map may show another marker
// and do not count.
std::vector<double> FactorsOfMarkers(const MapProblem& problem, const MapSolution& solution) {
  constexpr std::size_t kMinNumViews = 16;
  std::vector<double> factors(problem.markers.size(), 0.0);
  for (std::size_t marker_idx = 0; marker_idx < problem.markers.size(); ++marker_idx) {
    if (solution.shape_from_marker[marker_idx].empty()) continue;
    std::vector<double> relative;
    for (const int idx : problem.markers[marker_idx].observation_idxs) {
      const MapObservation& observation = problem.Observation(idx);
      if (!solution.Pose(observation.frame_idx)) continue;
      const double error_px = ReprojectionError(problem, solution, observation);
      if (error_px <= GrowthTolerance(observation)) {
        relative.push_back(error_px / observation.sigma_px);
      }
    }
    if (relative.size() < kMinNumViews) continue;
    factors[marker_idx] = SigmaFromMedian(Median(std::move(relative)), kChiSquaredMedian8);
  }
  return factors;
}

}  // namespace

MapNoise EstimateNoise(const MapProblem& problem, const MapSolution& solution) {
  MapNoise noise;
  noise.factor_of_frame.assign(problem.frames.size(), 0.0);
  noise.single_marker_factor_of_frame = noise.factor_of_frame;
  std::vector<double> relative, errors_px, single_marker_px;
  std::vector<std::vector<double>> relative_of_frame(problem.frames.size());
  std::vector<std::vector<double>> single_of_frame(problem.frames.size());
  noise.factor_of_marker = FactorsOfMarkers(problem, solution);
  for (std::size_t idx = 0; idx < problem.observations.size(); ++idx) {
    if (!solution.is_inlier[idx]) continue;
    const MapObservation& observation = problem.observations[idx];
    const double error_px = ReprojectionError(problem, solution, observation);
    relative.push_back(error_px / observation.sigma_px);
    errors_px.push_back(error_px);
    single_marker_px.push_back(observation.single_marker_error_px);
    const auto frame_idx = static_cast<std::size_t>(observation.frame_idx);
    relative_of_frame[frame_idx].push_back(relative.back());
    single_of_frame[frame_idx].push_back(observation.single_marker_error_px / observation.sigma_px);
  }
  if (relative.empty()) return noise;
  // A marker at a known place has 8 degrees of freedom, and 2 after a fit of its pose.
  noise.factor = SigmaFromMedian(Median(std::move(relative)), kChiSquaredMedian8);
  noise.sigma_px = SigmaFromMedian(Median(std::move(errors_px)), kChiSquaredMedian8);
  noise.single_marker_sigma_px =
      SigmaFromMedian(Median(std::move(single_marker_px)), kChiSquaredMedian2);
  for (std::size_t idx = 0; idx < problem.frames.size(); ++idx) {
    if (relative_of_frame[idx].empty()) continue;
    noise.factor_of_frame[idx] =
        SigmaFromMedian(Median(std::move(relative_of_frame[idx])), kChiSquaredMedian8);
    noise.single_marker_factor_of_frame[idx] =
        SigmaFromMedian(Median(std::move(single_of_frame[idx])), kChiSquaredMedian2);
  }
  return noise;
}

double FinalTolerance(const MapObservation& observation, const MapNoise& noise) {
  // The RMS distance of four corners is 1.4 sigma of a coordinate; 5 sigma is 3.5 times that, which
  // no good observation reaches.
  constexpr double kSigmas = 5.0;
  const double factor = std::max(
      {noise.factor, noise.factor_of_frame[static_cast<std::size_t>(observation.frame_idx)],
       noise.factor_of_marker[static_cast<std::size_t>(observation.marker_idx)], kMinNoiseFactor});
  return kSigmas * factor * observation.sigma_px;
}

void MarkFinalInliers(const MapProblem& problem, const MapNoise& noise, MapSolution* solution) {
  for (std::size_t idx = 0; idx < problem.observations.size(); ++idx) {
    const MapObservation& observation = problem.observations[idx];
    solution->is_inlier[idx] =
        ReprojectionError(problem, *solution, observation) <= FinalTolerance(observation, noise);
  }
}

void MarkMovedViews(const MapProblem& problem, MapSolution* solution) {
  for (std::size_t marker_idx = 0; marker_idx < problem.markers.size(); ++marker_idx) {
    if (solution->shape_from_marker[marker_idx].empty()) continue;
    std::vector<int> idxs;
    std::vector<TrackedView> views;
    for (const int idx : problem.markers[marker_idx].observation_idxs) {
      const MapObservation& observation = problem.Observation(idx);
      if (!solution->Pose(observation.frame_idx)) continue;
      idxs.push_back(idx);
      views.push_back({CornerErrorsPx(problem, *solution, observation), observation.side_px,
                       !solution->IsInlier(idx)});
    }
    const std::vector<bool> is_moved = FindMovedViews(views);
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (is_moved[i]) solution->is_inlier[static_cast<std::size_t>(idxs[i])] = 1;
    }
  }
}

bool IsSuspicious(const MapNoise& noise) {
  // The errors of a right shape are within twice the noise of the corners, lens and cloth included.
  constexpr double kRatio = 4.0, kNegligiblePx = 0.25;
  return noise.sigma_px > kNegligiblePx && noise.sigma_px > kRatio * noise.single_marker_sigma_px;
}

std::string OutlierReason(const MapProblem& problem, const MapSolution& solution,
                          const MapNoise& noise, const MapObservation& observation) {
  const double tolerance_px =
      std::max(FinalTolerance(observation, noise), GrowthTolerance(observation));
  for (int other_idx = 0; other_idx < static_cast<int>(problem.markers.size()); ++other_idx) {
    if (other_idx == observation.marker_idx || solution.Places(other_idx).empty()) continue;
    if (ErrorAs(problem, solution, observation, other_idx, 0) <= tolerance_px) {
      return fmt::format("wrong id: marker {} is there", problem.Marker(other_idx).marker_id);
    }
  }
  for (int quarters = 1; quarters < kNumCorners; ++quarters) {
    if (ErrorAs(problem, solution, observation, observation.marker_idx, quarters) <= tolerance_px) {
      return fmt::format("corners numbered from the wrong one, turned by {} degrees",
                         90 * quarters);
    }
  }
  const auto errors_px = CornerErrorsPx(problem, solution, observation);
  const double corner_tolerance_px = FinalTolerance(observation, noise);
  std::string corners;
  int num_off = 0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    if (errors_px[i].norm() <= corner_tolerance_px) continue;
    ++num_off;
    corners += (corners.empty() ? "corner " : ", ") + std::to_string(i + 1) + " off by " +
               Px(errors_px[i].norm());
  }
  if (num_off > 0 && num_off < kNumCorners) return corners;
  return Px(ReprojectionError(problem, solution, observation)) + " from its place";
}

PlacedMarker SupportOf(const MapProblem& problem, const MapSolution& solution,
                       const MapNoise& noise, int marker_idx) {
  const MapMarker& marker = problem.Marker(marker_idx);
  const Sim3& place = solution.Places(marker_idx).front();
  const auto corners = CornersInShape(marker, place);
  PlacedMarker placed;
  placed.marker_id = marker.marker_id;
  placed.center_in_shape_m = place.translation;
  placed.sigma_m = CenterSigma(problem, solution, noise, marker_idx);
  std::vector<char> sees(problem.frames.size(), 0);
  for (const int idx : marker.observation_idxs) {
    if (!solution.IsInlier(idx)) continue;
    sees[static_cast<std::size_t>(problem.Observation(idx).frame_idx)] = 1;
    ++placed.num_seen;
  }
  std::vector<std::optional<double>> width_px_of(problem.frames.size());
  std::vector<double> seen_widths_px;
  for (std::size_t idx = 0; idx < problem.frames.size(); ++idx) {
    const auto& pose = solution.cam_from_shape[idx];
    if (!pose) continue;
    width_px_of[idx] = ShownWidth(problem.frames[idx], *pose, corners);
    if (sees[idx] && width_px_of[idx]) seen_widths_px.push_back(*width_px_of[idx]);
  }
  if (seen_widths_px.empty()) return placed;
  const double usual_px = Median(std::move(seen_widths_px));
  for (std::size_t idx = 0; idx < problem.frames.size(); ++idx) {
    if (!width_px_of[idx] || *width_px_of[idx] < usual_px) continue;
    ++placed.num_should_see;
    placed.num_seen_of_these += sees[idx];
  }
  return placed;
}

}  // namespace velamap
