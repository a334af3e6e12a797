#include "tests/reconstruct/map/scene_map.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "importer/geometry/alignment.h"
#include "reconstruct/geometry/marker_pose.h"

namespace velamap {

SceneMap::SceneMap(SyntheticScene the_scene)
    : scene(std::move(the_scene)), cameras(SceneCameras(scene)), images(DatabaseImages(scene)) {
  std::vector<const DatabaseImage*> pointers;
  for (const DatabaseImage& image : images) pointers.push_back(&image);
  problem = MakeMapProblem(pointers, cameras, scene.layout);
}

int SceneMap::MarkerIdx(int marker_id) const {
  const auto marker = std::find_if(problem.markers.begin(), problem.markers.end(),
                                   [&](const auto& m) { return m.marker_id == marker_id; });
  return static_cast<int>(marker - problem.markers.begin());
}

int SceneMap::ObservationIdx(int frame_idx, int marker_id) const {
  for (const int idx : problem.Frame(frame_idx).observation_idxs) {
    if (problem.Marker(problem.Observation(idx).marker_idx).marker_id == marker_id) return idx;
  }
  return -1;
}

Sim3 SceneMap::TruePlace(int marker_idx) const {
  const auto corners = CornersInMarker(scene.layout.marker_length_m);
  const auto& points = scene.x_in_world.at(problem.Marker(marker_idx).marker_id);
  const Rigid3 world_from_marker =
      EstimateRigid3({corners.begin(), corners.end()}, {points.begin() + 1, points.end()});
  return {1.0, world_from_marker.rotation, world_from_marker.translation};
}

MapSolution SceneMap::TrueSolution() const {
  MapSolution solution = EmptySolution(problem);
  for (std::size_t idx = 0; idx < problem.frames.size(); ++idx) {
    solution.cam_from_shape[idx] = scene.cam_from_world[idx];
  }
  for (std::size_t idx = 0; idx < problem.markers.size(); ++idx) {
    if (scene.x_in_world.count(problem.markers[idx].marker_id) == 0) continue;
    solution.shape_from_marker[idx] = {TruePlace(static_cast<int>(idx))};
  }
  solution.is_inlier.assign(problem.observations.size(), 1);
  return solution;
}

SceneMap NoisySail(double corner_sigma_px, std::uint32_t seed) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 15, false);
  SyntheticNoiseOptions noise;
  noise.corner_sigma_px = corner_sigma_px;
  noise.seed = seed;
  AddNoise(noise, &scene);
  SceneMap map(std::move(scene));
  SetSigma(corner_sigma_px > 0 ? corner_sigma_px : 0.2, &map.problem);
  return map;
}

void SetSigma(double sigma_px, MapProblem* problem) {
  for (MapObservation& observation : problem->observations) observation.sigma_px = sigma_px;
}

MarkerDetection* FindDetection(int marker_id, FrameDetections* frame) {
  for (MarkerDetection& marker : frame->markers) {
    if (marker.marker_id == marker_id) return &marker;
  }
  return nullptr;
}

bool RemoveDetection(int marker_id, FrameDetections* frame) {
  const MarkerDetection* detection = FindDetection(marker_id, frame);
  if (detection == nullptr) return false;
  frame->markers.erase(frame->markers.begin() + (detection - frame->markers.data()));
  return true;
}

void SortMarkers(FrameDetections* frame) {
  std::sort(frame->markers.begin(), frame->markers.end(),
            [](const auto& a, const auto& b) { return a.marker_id < b.marker_id; });
}

void ExchangeIds(double rate, std::uint32_t seed, SyntheticScene* scene) {
  std::mt19937 generator(seed);
  for (FrameDetections& frame : scene->frames) {
    std::vector<std::size_t> idxs(frame.markers.size());
    std::iota(idxs.begin(), idxs.end(), 0);
    std::shuffle(idxs.begin(), idxs.end(), generator);
    const std::size_t count = static_cast<std::size_t>(rate * static_cast<double>(idxs.size()));
    if (count < 2) continue;
    const int first_id = frame.markers[idxs[0]].marker_id;
    for (std::size_t i = 0; i + 1 < count; ++i) {
      frame.markers[idxs[i]].marker_id = frame.markers[idxs[i + 1]].marker_id;
    }
    frame.markers[idxs[count - 1]].marker_id = first_id;
    SortMarkers(&frame);
  }
}

void TurnCorners(double rate, std::uint32_t seed, SyntheticScene* scene) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (FrameDetections& frame : scene->frames) {
    for (MarkerDetection& marker : frame.markers) {
      if (unit(generator) >= rate) continue;
      auto& corners = marker.corners_in_image_px;
      std::rotate(corners.begin(), corners.begin() + 1 + static_cast<int>(3 * unit(generator)),
                  corners.end());
    }
  }
}

std::vector<int> ReadSevenAtTwentyOne(std::size_t step, SyntheticScene* scene) {
  std::vector<int> frame_idxs;
  for (std::size_t i = 0; i < scene->frames.size(); i += step) {
    FrameDetections& frame = scene->frames[i];
    MarkerDetection* seven = FindDetection(7, &frame);
    const MarkerDetection* twenty_one = FindDetection(21, &frame);
    if (seven == nullptr || twenty_one == nullptr) continue;
    seven->corners_in_image_px = twenty_one->corners_in_image_px;
    frame_idxs.push_back(static_cast<int>(i));
  }
  return frame_idxs;
}

int PlantFalseMarker(int marker_id, const Eigen::Vector3d& shift_m, int num_frames,
                     SyntheticScene* scene) {
  int num_planted = 0;
  for (std::size_t i = 0; i < scene->frames.size(); ++i) {
    FrameDetections& frame = scene->frames[i];
    MarkerDetection* detection = FindDetection(marker_id, &frame);
    if (detection == nullptr) continue;
    bool is_seen = num_planted < num_frames;
    for (std::size_t corner = 0; corner < kNumCorners && is_seen; ++corner) {
      const auto image_px =
          ImageFromCam(scene->camera, scene->cam_from_world[i] *
                                          (scene->x_in_world.at(marker_id)[corner + 1] + shift_m));
      is_seen = image_px && (image_px->array() > 0).all() &&
                image_px->x() < scene->camera.width_px && image_px->y() < scene->camera.height_px;
      if (is_seen) detection->corners_in_image_px[corner] = *image_px;
    }
    num_planted += is_seen;
    if (!is_seen) RemoveDetection(marker_id, &frame);
  }
  return num_planted;
}

void BlurFrames(double sigma_px, std::uint32_t seed, SyntheticScene* scene) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, sigma_px);
  for (std::size_t i = 5; i < scene->frames.size(); i += 10) {
    for (MarkerDetection& marker : scene->frames[i].markers) {
      for (Eigen::Vector2d& corner : marker.corners_in_image_px) {
        corner += Eigen::Vector2d(normal(generator), normal(generator));
      }
    }
  }
}

MapSolution Transformed(const Sim3& new_from_shape, const MapSolution& solution) {
  MapSolution transformed = solution;
  for (auto& pose : transformed.cam_from_shape) {
    if (!pose) continue;
    // Scales the cam frames along with the shape, so that the images stay.
    pose->rotation = (pose->rotation * new_from_shape.rotation.conjugate()).normalized();
    pose->translation =
        new_from_shape.scale * pose->translation - pose->rotation * new_from_shape.translation;
  }
  for (auto& places : transformed.shape_from_marker) {
    for (Sim3& place : places) {
      place = {new_from_shape.scale * place.scale,
               (new_from_shape.rotation * place.rotation).normalized(),
               new_from_shape * place.translation};
    }
  }
  return transformed;
}

Sim3 ArbitrarySimilarity(double scale) {
  return {scale, Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized(), {1.5, -0.7, 3.1}};
}

double MaxCornerDistance(const MapProblem& problem, const MapSolution& a, const MapSolution& b) {
  double max_distance = 0.0;
  for (std::size_t idx = 0; idx < problem.markers.size(); ++idx) {
    if (a.shape_from_marker[idx].empty() || b.shape_from_marker[idx].empty()) continue;
    for (const Eigen::Vector3d& x_in_marker : problem.markers[idx].corners_in_marker) {
      max_distance = std::max(max_distance, (a.shape_from_marker[idx].front() * x_in_marker -
                                             b.shape_from_marker[idx].front() * x_in_marker)
                                                .norm());
    }
  }
  return max_distance;
}

std::vector<int> AllFrames(const MapProblem& problem) {
  std::vector<int> frame_idxs(problem.frames.size());
  std::iota(frame_idxs.begin(), frame_idxs.end(), 0);
  return frame_idxs;
}

Eigen::Matrix<double, 8, 1> Residuals(const MapProblem& problem, const MapObservation& observation,
                                      const Rigid3& cam_from_shape, const Sim3& shape_from_marker) {
  Eigen::Matrix<double, 8, 1> residuals;
  const auto& corners = problem.Marker(observation.marker_idx).corners_in_marker;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const Eigen::Vector3d x_in_cam = cam_from_shape * (shape_from_marker * corners[i]);
    residuals.segment<2>(2 * static_cast<Eigen::Index>(i)) =
        observation.px_from_ray[i] * (x_in_cam.hnormalized() - observation.rays[i]) /
        observation.sigma_px;
  }
  return residuals;
}

namespace {

Eigen::Quaterniond Turned(const Eigen::Vector3d& turn, const Eigen::Quaterniond& rotation) {
  const Eigen::AngleAxisd by(
      turn.norm(), turn.norm() > 0 ? Eigen::Vector3d(turn.normalized()) : Eigen::Vector3d::UnitX());
  return (by * rotation).normalized();
}

Eigen::Vector3d TurnBetween(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  const Eigen::AngleAxisd turn(to * from.conjugate());
  return turn.angle() * turn.axis();
}

// J^T J of an observation; `residuals_at` takes a step of size N.
template <int N, typename ResidualsAt>
Eigen::Matrix<double, N, N> Information(const ResidualsAt& residuals_at) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix<double, 8, N> jacobian;
  for (int i = 0; i < N; ++i) {
    const Eigen::Matrix<double, N, 1> step = kStep * Eigen::Matrix<double, N, 1>::Unit(i);
    jacobian.col(i) = (residuals_at(step) - residuals_at(-step)) / (2 * kStep);
  }
  return jacobian.transpose() * jacobian;
}

}  // namespace

Rigid3 Stepped(const Rigid3& pose, const Eigen::Matrix<double, 6, 1>& step) {
  return {Turned(step.head<3>(), pose.rotation), pose.translation + step.tail<3>()};
}

Sim3 Stepped(const Sim3& place, const Eigen::Matrix<double, 7, 1>& step) {
  return {place.scale * std::exp(step[6]), Turned(step.head<3>(), place.rotation),
          place.translation + step.segment<3>(3)};
}

Eigen::Matrix<double, 6, 1> StepBetween(const Rigid3& from, const Rigid3& to) {
  Eigen::Matrix<double, 6, 1> step;
  step << TurnBetween(from.rotation, to.rotation), to.translation - from.translation;
  return step;
}

Eigen::Matrix<double, 7, 1> StepBetween(const Sim3& from, const Sim3& to) {
  Eigen::Matrix<double, 7, 1> step;
  step << TurnBetween(from.rotation, to.rotation), to.translation - from.translation,
      std::log(to.scale / from.scale);
  return step;
}

Eigen::Matrix<double, 6, 6> PoseInformation(const MapProblem& problem, const MapSolution& solution,
                                            int frame_idx) {
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  const Rigid3& pose = *solution.Pose(frame_idx);
  for (const int idx : problem.Frame(frame_idx).observation_idxs) {
    const MapObservation& observation = problem.Observation(idx);
    const auto& places = solution.Places(observation.marker_idx);
    if (places.empty()) continue;
    information += Information<6>([&](const Eigen::Matrix<double, 6, 1>& step) {
      return Residuals(problem, observation, Stepped(pose, step), places.front());
    });
  }
  return information;
}

Eigen::Matrix<double, 7, 7> PlaceInformation(const MapProblem& problem, const MapSolution& solution,
                                             int marker_idx) {
  Eigen::Matrix<double, 7, 7> information = Eigen::Matrix<double, 7, 7>::Zero();
  const Sim3& place = solution.Places(marker_idx).front();
  for (const int idx : problem.Marker(marker_idx).observation_idxs) {
    const MapObservation& observation = problem.Observation(idx);
    const auto& pose = solution.Pose(observation.frame_idx);
    if (!pose) continue;
    information += Information<7>([&](const Eigen::Matrix<double, 7, 1>& step) {
      return Residuals(problem, observation, *pose, Stepped(place, step));
    });
  }
  return information;
}

}  // namespace velamap
