#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "importer/geometry/alignment.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/correlation/error_correlation.h"
#include "reconstruct/sizes/size_deviations.h"
#include "tests/reconstruct/problem/tiny_scene.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

constexpr double kFlap_m = 0.02;

// A sail whose last markers leave it by up to kFlap_m, to and fro once in `period` frames.
struct FlappingSail {
  SyntheticScene scene;
  std::set<int> moving_ids;
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();  // its unit vector, the last marker's normal

  int LastId() const { return *moving_ids.rbegin(); }
};

SyntheticScene StillSail() {
  SyntheticSceneOptions options;
  options.num_rows = 4;
  options.num_columns = 5;
  options.num_frames = 40;
  return MakeSyntheticScene(options);
}

FlappingSail Flap(double period, int num_moving) {
  FlappingSail sail;
  sail.scene = StillSail();
  for (auto marker = sail.scene.x_in_world.rbegin(); num_moving > 0; ++marker, --num_moving) {
    sail.moving_ids.insert(marker->first);
  }
  const auto& last = sail.scene.x_in_world.at(sail.LastId());
  sail.motion = (last[1] - last[3]).cross(last[2] - last[4]).normalized();
  for (std::size_t i = 0; i < sail.scene.frames.size(); ++i) {
    const Eigen::Vector3d shift =
        kFlap_m * std::sin(2 * 3.14159265358979 * static_cast<double>(i) / period) * sail.motion;
    for (MarkerDetection& marker : sail.scene.frames[i].markers) {
      if (sail.moving_ids.count(marker.marker_id) == 0) continue;
      const auto& x_in_world = sail.scene.x_in_world.at(marker.marker_id);
      for (std::size_t corner = 0; corner < kNumCorners; ++corner) {
        marker.corners_in_image_px[corner] = *ImageFromCam(
            sail.scene.camera, sail.scene.cam_from_world[i] * (x_in_world[corner + 1] + shift));
      }
    }
  }
  AddNoise({0.1, 0, 0, 0, 3}, &sail.scene);
  return sail;
}

// Leaves the marker only in frames `first` to `last`.
void HideOutside(std::size_t first, std::size_t last, int marker_id, SyntheticScene* scene) {
  for (std::size_t i = 0; i < scene->frames.size(); ++i) {
    if (first <= i && i <= last) continue;
    std::vector<MarkerDetection>& markers = scene->frames[i].markers;
    markers.erase(std::remove_if(markers.begin(), markers.end(),
                                 [marker_id](const MarkerDetection& marker) {
                                   return marker.marker_id == marker_id;
                                 }),
                  markers.end());
  }
}

// Distance of a marker's centre from the truth and its stated sigma, m, in the frame of the first
// image.
struct CentreError {
  double error_m = 0.0, sigma_m = 0.0;
};

CentreError CentreErrorOf(int marker_id, const SyntheticScene& scene, const Model& model,
                          const PointCovariance& covariance) {
  const Rigid3& first_from_world = scene.cam_from_world[model.images.front().image_id - 1];
  Eigen::Vector3d error_m = Eigen::Vector3d::Zero();
  double variance = 0.0;
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    const Point3DId id = Point3DIdFromCorner({marker_id, corner});
    error_m +=
        (model.points3D.at(id).x_in_world -
         first_from_world * scene.x_in_world.at(marker_id)[static_cast<std::size_t>(corner)]) /
        kNumCorners;
    variance += PointCovarianceOf(covariance, id).trace() / kNumCorners;
  }
  return {error_m.norm(), std::sqrt(variance)};
}

// RMS distance of the points from the truth after a rigid alignment, m.
double ShapeError(const SyntheticScene& scene, const Model& model) {
  std::vector<Eigen::Vector3d> found, truth;
  for (const auto& [point3D_id, point] : model.points3D) {
    const CornerId id = CornerFromPoint3DId(point3D_id);
    found.push_back(point.x_in_world);
    truth.push_back(scene.x_in_world.at(id.marker_id)[static_cast<std::size_t>(id.corner)]);
  }
  const Rigid3 truth_from_found = EstimateRigid3(found, truth);
  double squares = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    squares += (truth_from_found * found[i] - truth[i]).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(found.size()));
}

// Begins where the marker is at one end of its motion, as a registration may leave it that takes
// the other images for outliers.
TEST(MovingMarker, HasItsMeanPlaceAndASigmaThatContainsTheMotion) {
  const FlappingSail sail = Flap(11, 1);
  Model model = MakeSceneModel(sail.scene);
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    model.points3D.at(Point3DIdFromCorner({sail.LastId(), corner})).x_in_world +=
        kFlap_m * sail.motion;
  }
  const MarkerAdjustmentSummary summary = AdjustWithMarkers({}, sail.scene.layout, {}, &model);
  double largest_m = 0.0, usual_sigma_m = 0.0;
  for (const auto& [marker_id, x_in_world] : sail.scene.x_in_world) {
    const CentreError found =
        CentreErrorOf(marker_id, sail.scene, model, summary.uncertainty.points);
    if (marker_id == sail.LastId()) {
      EXPECT_LT(found.error_m, 0.25 * kFlap_m);
      EXPECT_LT(found.error_m, 3 * found.sigma_m);
      EXPECT_LT(found.sigma_m, 0.5 * kFlap_m);
    } else {
      largest_m = std::max(largest_m, found.error_m);
      usual_sigma_m = std::max(usual_sigma_m, found.sigma_m);
    }
  }
  EXPECT_LT(largest_m, 3 * usual_sigma_m);
}

// Five frames agree on a place of the marker that only they know of.
TEST(MovingMarker, OfFewFramesHasASigmaThatContainsTheMotionOfItsNeighbours) {
  FlappingSail sail = Flap(20, 5);
  HideOutside(13, 17, sail.LastId(), &sail.scene);
  Model model = MakeSceneModel(sail.scene);
  const MarkerAdjustmentSummary summary = AdjustWithMarkers({}, sail.scene.layout, {}, &model);
  for (const int marker_id : sail.moving_ids) {
    const CentreError found =
        CentreErrorOf(marker_id, sail.scene, model, summary.uncertainty.points);
    EXPECT_LT(found.error_m, 3 * found.sigma_m) << "marker " << marker_id;
    EXPECT_LT(found.sigma_m, 2 * kFlap_m) << "marker " << marker_id;
  }
}

// A wave runs along the sail: every marker moves, and none more than the others.
SyntheticScene WavingSail() {
  SyntheticScene scene = StillSail();
  const auto& first = scene.x_in_world.begin()->second;
  const Eigen::Vector3d normal = (first[1] - first[3]).cross(first[2] - first[4]).normalized();
  const Eigen::Vector3d along = (first[2] - first[1]).normalized();
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    for (MarkerDetection& marker : scene.frames[i].markers) {
      const auto& x_in_world = scene.x_in_world.at(marker.marker_id);
      for (std::size_t corner = 0; corner < kNumCorners; ++corner) {
        const Eigen::Vector3d& x = x_in_world[corner + 1];
        const double phase = 2 * M_PI * (static_cast<double>(i) / 11 - along.dot(x) / 1.5);
        marker.corners_in_image_px[corner] = *ImageFromCam(
            scene.camera, scene.cam_from_world[i] * (x + 0.5 * kFlap_m * std::sin(phase) * normal));
      }
    }
  }
  AddNoise({0.1, 0, 0, 0, 3}, &scene);
  return scene;
}

TEST(MovingMarker, AWholeSailThatFlapsKeepsItsViews) {
  const SyntheticScene scene = WavingSail();
  CornerErrors frames_of_video;
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    frames_of_video.motions[static_cast<ImageId>(i + 1)] =
        std::vector<CornerMotion>(kNumCorners * scene.frames[i].markers.size());
  }
  MarkerAdjustmentOptions options;
  options.estimate_rolling_shutter = false;
  Model model = MakeSceneModel(scene);
  std::size_t num_corners = 0;
  for (const auto& [point3D_id, point] : model.points3D) num_corners += point.track.size();
  const MarkerAdjustmentSummary summary =
      AdjustWithMarkers(options, scene.layout, frames_of_video, &model);
  EXPECT_LT(summary.removed.size(), 0.01 * static_cast<double>(num_corners));
  EXPECT_LT(ShapeError(scene, model), 0.075 * kFlap_m);
}

double SizeCorrelationFactorOf(const SyntheticScene& scene) {
  Model model = MakeSceneModel(scene);
  AdjustWithMarkers({}, scene.layout, {}, &model);
  MarkerState state = MakeMarkerState(model, scene.layout);
  const MarkerProblem problem =
      MakeMarkerProblem({}, model, {}, model.cameras, WeightsWithoutLoss(), &state);
  const MarkerJacobian jacobian = EvaluateJacobian(problem);
  const auto covariance = InvertNormalEquations(jacobian, 1);
  return CorrelationFactorOf(SizesByPoints(state, *covariance), state, problem, jacobian,
                             *covariance, GroupImages(model, kNumCorrelationGroups), 1);
}

// The images alone show markers of a flapping sail too large or too small. That is no fault of
// their print.
TEST(MovingMarker, TheirSizesAreKnownLessThanIndependentErrorsWouldSay) {
  const FlappingSail sail = Flap(20, 5);
  EXPECT_GT(SizeCorrelationFactorOf(sail.scene), 3.0);
  SyntheticScene still = StillSail();
  AddNoise({0.1, 0, 0, 0, 3}, &still);
  EXPECT_LT(SizeCorrelationFactorOf(still), 1.2);
}

}  // namespace
}  // namespace velamap
