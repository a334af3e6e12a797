// The problem of global registration and its solution: poses of frames and places of markers.
// Corners are undistorted once; the derivative px_from_ray converts errors of rays to px of the
// image.

#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "importer/camera/camera.h"
#include "importer/database/colmap_database.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/layout.h"

namespace velamap {

// One marker in one frame.
struct MapObservation {
  int frame_idx = 0;
  int marker_idx = 0;
  std::array<Eigen::Vector2d, kNumCorners> rays;         // (x/z, y/z) in the cam frame
  std::array<Eigen::Matrix2d, kNumCorners> px_from_ray;  // derivative of the image position there
  double sigma_px = 0.0;                                 // of a coordinate of a corner
  double side_px = 0.0;                                  // mean length of a side in the image
  std::vector<Rigid3> cam_from_marker;  // from this observation alone: one or two, the better first
  double single_marker_error_px = 0.0;  // RMS over the corners in the better of these poses
};

struct MapFrame {
  const DatabaseImage* image = nullptr;
  const Camera* camera = nullptr;
  std::vector<int> observation_idxs;  // by marker_idx
};

struct MapMarker {
  int marker_id = 0;
  std::array<Eigen::Vector3d, kNumCorners> corners_in_marker;  // m
  std::vector<int> observation_idxs;                           // by frame_idx
};

struct MapProblem {
  std::vector<MapFrame> frames;
  std::vector<MapMarker> markers;  // by ascending id
  std::vector<MapObservation> observations;

  const MapObservation& Observation(int idx) const {
    return observations[static_cast<std::size_t>(idx)];
  }
  const MapFrame& Frame(int idx) const { return frames[static_cast<std::size_t>(idx)]; }
  const MapMarker& Marker(int idx) const { return markers[static_cast<std::size_t>(idx)]; }
};

// A marker is a square of its nominal side times the scale. The scale absorbs errors that all views
// of a marker share (its print, a biased corner estimator); a prior holds it near 1.
struct MapSolution {
  std::vector<std::optional<Rigid3>> cam_from_shape;  // by frame_idx; none: not registered
  // By marker_idx: none where the marker has no place yet, two where the views do not decide
  // between two places yet (the better first).
  std::vector<std::vector<Sim3>> shape_from_marker;
  std::vector<char> is_inlier;  // by observation_idx: the observation agrees with frame and marker

  const std::optional<Rigid3>& Pose(int frame_idx) const {
    return cam_from_shape[static_cast<std::size_t>(frame_idx)];
  }
  const std::vector<Sim3>& Places(int marker_idx) const {
    return shape_from_marker[static_cast<std::size_t>(marker_idx)];
  }
  bool IsInlier(int observation_idx) const {
    return is_inlier[static_cast<std::size_t>(observation_idx)] != 0;
  }
  int NumRegistered() const;
};

// Estimates the poses of each marker from each of its observations separately. The frames get their
// frame_idx in the order of `images`. `num_threads` 0: one per core; never changes the result.
MapProblem MakeMapProblem(const std::vector<const DatabaseImage*>& images,
                          const std::map<CameraId, Camera>& cameras, const Layout& layout,
                          int num_threads = 0);

MapSolution EmptySolution(const MapProblem& problem);

// RMS distance of the four corners from their projections with the given pose and place, px.
// Infinite if a corner is not in front of the camera.
double ReprojectionError(const MapProblem& problem, const MapObservation& observation,
                         const Rigid3& cam_from_shape, const Sim3& shape_from_marker);

// The same for a solution: the smaller error where the marker has two places; infinite if the
// frame has no pose or the marker no place.
double ReprojectionError(const MapProblem& problem, const MapSolution& solution,
                         const MapObservation& observation);

// The reprojection error (px) of the observation if it showed the marker `as_marker_idx`, with the
// corners renumbered by `quarters` quarter turns. The frame must have a pose, and that marker a
// place.
double ErrorAs(const MapProblem& problem, const MapSolution& solution, MapObservation observation,
               int as_marker_idx, int quarters);

// Largest error (px) of an inlier while the map grows and is not precise yet: a tenth of the
// marker's side, but at least 2 px. A wrong id or corner is off by a side or more.
double GrowthTolerance(const MapObservation& observation);

// Marks the observations of registered frames and placed markers that are within
// `factor` * GrowthTolerance.
void MarkInliers(const MapProblem& problem, double factor, MapSolution* solution);

// The number of inliers among the observations of the marker.
int NumInliers(const MapProblem& problem, const MapSolution& solution, int marker_idx);

// The number of markers with a place that the frame shows.
int NumKnown(const MapProblem& problem, const MapSolution& solution, int frame_idx);

// The corners of a marker in the shape frame, m.
std::array<Eigen::Vector3d, kNumCorners> CornersInShape(const MapMarker& marker,
                                                        const Sim3& shape_from_marker);

// c_from_a, of a similarity followed by a rigid motion.
inline Sim3 operator*(const Rigid3& c_from_b, const Sim3& b_from_a) {
  return {b_from_a.scale, (c_from_b.rotation * b_from_a.rotation).normalized(),
          c_from_b * b_from_a.translation};
}

}  // namespace velamap
