#include "reconstruct/map/map_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "importer/base/parallel.h"
#include "importer/camera/camera_jacobian.h"
#include "importer/geometry/quad.h"
#include "reconstruct/geometry/marker_pose.h"

namespace velamap {
namespace {

// Sigma of a coordinate of a corner where the detector gives none, px.
constexpr double kDefaultSigmaPx = 0.2;
// Errors that the detector's sigma does not cover: the lens, and bent squares (fraction of the
// side).
constexpr double kSigmaFloorPx = 0.05;
constexpr double kBendSigma = 0.004;

double SigmaPx(const MarkerDetection& detection, double side_px) {
  double sum = 0.0;
  for (const double sigma_px : detection.corner_sigma_px) {
    const double known_or_default = sigma_px > 0 ? sigma_px : kDefaultSigmaPx;
    sum += known_or_default * known_or_default / kNumCorners;
  }
  return std::sqrt(sum + kSigmaFloorPx * kSigmaFloorPx + std::pow(kBendSigma * side_px, 2));
}

std::optional<MapObservation> Observe(const MarkerDetection& detection, const Camera& camera,
                                      double length_m) {
  MapObservation observation;
  const auto& corners_px = detection.corners_in_image_px;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const auto ray = CamFromImage(camera, corners_px[i]);
    if (!ray) return std::nullopt;
    observation.rays[i] = *ray;
    observation.px_from_ray[i] =
        ImageFromRayWithJacobian(camera.model, camera.params.data(), *ray).by_ray;
  }
  observation.side_px = QuadMeanSide(corners_px);
  const auto poses = EstimateMarkerPoses(camera, corners_px, length_m);
  if (poses.empty()) return std::nullopt;
  for (const MarkerPose& pose : poses) {
    observation.cam_from_marker.push_back(pose.cam_from_marker);
  }
  observation.single_marker_error_px = poses.front().rms_error_px;
  observation.sigma_px = SigmaPx(detection, observation.side_px);
  return observation;
}

}  // namespace

int MapSolution::NumRegistered() const {
  return static_cast<int>(std::count_if(cam_from_shape.begin(), cam_from_shape.end(),
                                        [](const auto& pose) { return pose.has_value(); }));
}

MapProblem MakeMapProblem(const std::vector<const DatabaseImage*>& images,
                          const std::map<CameraId, Camera>& cameras, const Layout& layout,
                          int num_threads) {
  MapProblem problem;
  std::map<int, int> marker_idx_of;
  for (const DatabaseImage* image : images) {
    problem.frames.push_back({image, &cameras.at(image->camera_id), {}});
    for (const MarkerDetection& marker : image->detections.markers) {
      marker_idx_of.emplace(marker.marker_id, 0);
    }
  }
  for (auto& [marker_id, marker_idx] : marker_idx_of) {
    marker_idx = static_cast<int>(problem.markers.size());
    problem.markers.push_back({marker_id, CornersInMarker(MarkerLength(layout, marker_id)), {}});
  }
  std::vector<std::vector<std::optional<MapObservation>>> observed(images.size());
  ParallelFor(images.size(), num_threads, [&](std::size_t frame_idx) {
    for (const MarkerDetection& marker : images[frame_idx]->detections.markers) {
      observed[frame_idx].push_back(Observe(marker, *problem.frames[frame_idx].camera,
                                            MarkerLength(layout, marker.marker_id)));
      if (!observed[frame_idx].back()) continue;
      observed[frame_idx].back()->frame_idx = static_cast<int>(frame_idx);
      observed[frame_idx].back()->marker_idx = marker_idx_of.at(marker.marker_id);
    }
  });
  for (auto& in_frame : observed) {
    for (auto& observation : in_frame) {
      if (!observation) continue;
      const int idx = static_cast<int>(problem.observations.size());
      problem.frames[static_cast<std::size_t>(observation->frame_idx)].observation_idxs.push_back(
          idx);
      problem.markers[static_cast<std::size_t>(observation->marker_idx)].observation_idxs.push_back(
          idx);
      problem.observations.push_back(std::move(*observation));
    }
  }
  return problem;
}

MapSolution EmptySolution(const MapProblem& problem) {
  MapSolution solution;
  solution.cam_from_shape.resize(problem.frames.size());
  solution.shape_from_marker.resize(problem.markers.size());
  solution.is_inlier.assign(problem.observations.size(), 0);
  return solution;
}

double ReprojectionError(const MapProblem& problem, const MapObservation& observation,
                         const Rigid3& cam_from_shape, const Sim3& shape_from_marker) {
  const Sim3 cam_from_marker = cam_from_shape * shape_from_marker;
  const Eigen::Matrix3d rotation =
      cam_from_marker.scale * cam_from_marker.rotation.toRotationMatrix();
  const auto& corners = problem.Marker(observation.marker_idx).corners_in_marker;
  double sum = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const Eigen::Vector3d x_in_cam = rotation * corners[i] + cam_from_marker.translation;
    if (!(x_in_cam.z() > 0)) return std::numeric_limits<double>::infinity();
    sum +=
        (observation.px_from_ray[i] * (x_in_cam.hnormalized() - observation.rays[i])).squaredNorm();
  }
  return std::sqrt(sum / kNumCorners);
}

double ReprojectionError(const MapProblem& problem, const MapSolution& solution,
                         const MapObservation& observation) {
  double error_px = std::numeric_limits<double>::infinity();
  const auto& pose = solution.Pose(observation.frame_idx);
  if (!pose) return error_px;
  for (const Sim3& place : solution.Places(observation.marker_idx)) {
    error_px = std::min(error_px, ReprojectionError(problem, observation, *pose, place));
  }
  return error_px;
}

double ErrorAs(const MapProblem& problem, const MapSolution& solution, MapObservation observation,
               int as_marker_idx, int quarters) {
  observation.marker_idx = as_marker_idx;
  std::rotate(observation.rays.begin(), observation.rays.begin() + quarters,
              observation.rays.end());
  std::rotate(observation.px_from_ray.begin(), observation.px_from_ray.begin() + quarters,
              observation.px_from_ray.end());
  return ReprojectionError(problem, observation, *solution.Pose(observation.frame_idx),
                           solution.Places(as_marker_idx).front());
}

double GrowthTolerance(const MapObservation& observation) {
  return std::max(2.0, 0.1 * observation.side_px);
}

void MarkInliers(const MapProblem& problem, double factor, MapSolution* solution) {
  for (std::size_t idx = 0; idx < problem.observations.size(); ++idx) {
    const MapObservation& observation = problem.observations[idx];
    solution->is_inlier[idx] =
        ReprojectionError(problem, *solution, observation) <= factor * GrowthTolerance(observation);
  }
}

int NumInliers(const MapProblem& problem, const MapSolution& solution, int marker_idx) {
  int count = 0;
  for (const int idx : problem.Marker(marker_idx).observation_idxs) {
    count += solution.IsInlier(idx);
  }
  return count;
}

int NumKnown(const MapProblem& problem, const MapSolution& solution, int frame_idx) {
  const auto& idxs = problem.Frame(frame_idx).observation_idxs;
  return static_cast<int>(std::count_if(idxs.begin(), idxs.end(), [&](int idx) {
    return !solution.Places(problem.Observation(idx).marker_idx).empty();
  }));
}

std::array<Eigen::Vector3d, kNumCorners> CornersInShape(const MapMarker& marker,
                                                        const Sim3& shape_from_marker) {
  std::array<Eigen::Vector3d, kNumCorners> corners;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    corners[i] = shape_from_marker * marker.corners_in_marker[i];
  }
  return corners;
}

}  // namespace velamap
