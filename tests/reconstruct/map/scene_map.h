// Shared by the tests of global registration: a synthetic scene as a MapProblem, its true solution,
// and ways to spoil the detections.

#pragma once

#include <map>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "reconstruct/map/map_problem.h"
#include "tests/reconstruct/registration_fixture.h"

namespace velamap {

// The problem points into images and cameras, so they are kept together. Movable, not copyable.
struct SceneMap {
  SyntheticScene scene;
  std::map<CameraId, Camera> cameras;
  std::vector<DatabaseImage> images;  // by frame_idx
  MapProblem problem;

  explicit SceneMap(SyntheticScene the_scene);
  SceneMap(const SceneMap&) = delete;
  SceneMap(SceneMap&&) = default;

  int MarkerIdx(int marker_id) const;
  // -1: the frame does not see the marker.
  int ObservationIdx(int frame_idx, int marker_id) const;
  Sim3 TruePlace(int marker_idx) const;  // world_from_marker, scale 1
  // All frames and markers where they are, in the world frame; all observations fit.
  MapSolution TrueSolution() const;
};

// A sail of 5 x 6 markers seen by 15 unordered photographs, with this noise and sigma_px equal to
// it (0: exact corners; sigma_px is then 0.2).
SceneMap NoisySail(double corner_sigma_px, std::uint32_t seed);

// Says that the detector knows the noise of its corners.
void SetSigma(double sigma_px, MapProblem* problem);

MarkerDetection* FindDetection(int marker_id, FrameDetections* frame);
// Returns whether the frame showed the marker.
bool RemoveDetection(int marker_id, FrameDetections* frame);
// Frames keep their markers by ascending id.
void SortMarkers(FrameDetections* frame);

// Gives `rate` of the detections the ids of one another, frame by frame.
void ExchangeIds(double rate, std::uint32_t seed, SyntheticScene* scene);
// Numbers the corners of `rate` of the detections from a wrong one.
void TurnCorners(double rate, std::uint32_t seed, SyntheticScene* scene);
// The id of marker 7 is read where marker 21 stands, in every `step`-th frame that shows both.
// Returns these frames.
std::vector<int> ReadSevenAtTwentyOne(std::size_t step, SyntheticScene* scene);
// Hides a marker, and shows the first `num_frames` frames that can see it a false square with its
// id at another place, moved by `shift_m` in the world frame. Returns the number of frames that do.
int PlantFalseMarker(int marker_id, const Eigen::Vector3d& shift_m, int num_frames,
                     SyntheticScene* scene);
// Blurs every tenth frame from the sixth on: the corners' sigma does not say so.
void BlurFrames(double sigma_px, std::uint32_t seed, SyntheticScene* scene);

// The same solution in another shape frame.
MapSolution Transformed(const Sim3& new_from_shape, const MapSolution& solution);
Sim3 ArbitrarySimilarity(double scale);

// Largest distance between the corners of the markers that both solutions have placed.
double MaxCornerDistance(const MapProblem& problem, const MapSolution& a, const MapSolution& b);

std::vector<int> AllFrames(const MapProblem& problem);

// Errors of four corners in units of sigma_px: x1 y1 x2 ... Independent of the code under test.
Eigen::Matrix<double, 8, 1> Residuals(const MapProblem& problem, const MapObservation& observation,
                                      const Rigid3& cam_from_shape, const Sim3& shape_from_marker);

// Rotation vector on the left, then translation.
Rigid3 Stepped(const Rigid3& pose, const Eigen::Matrix<double, 6, 1>& step);
// The same, then the logarithm of the scale.
Sim3 Stepped(const Sim3& place, const Eigen::Matrix<double, 7, 1>& step);

// Step that leads from one to the other.
Eigen::Matrix<double, 6, 1> StepBetween(const Rigid3& from, const Rigid3& to);
Eigen::Matrix<double, 7, 1> StepBetween(const Sim3& from, const Sim3& to);

// Information matrix of a frame's pose from all placed markers that it sees, and of a marker's
// place from all registered frames that see it, by central differences at the solution; without
// priors.
Eigen::Matrix<double, 6, 6> PoseInformation(const MapProblem& problem, const MapSolution& solution,
                                            int frame_idx);
Eigen::Matrix<double, 7, 7> PlaceInformation(const MapProblem& problem, const MapSolution& solution,
                                             int marker_idx);

}  // namespace velamap
