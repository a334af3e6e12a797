#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "reconstruct/adjust/marker_adjustment.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

constexpr double kFlap_m = 0.02;

// A sail that one marker of leaves by up to kFlap_m, to and fro once in `period` frames.
struct FlappingSail {
  SyntheticScene scene;
  int marker_id = 0;  // the one that moves
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

FlappingSail Flap(double period) {
  SyntheticSceneOptions options;
  options.num_rows = 4;
  options.num_columns = 5;
  options.num_frames = 40;
  FlappingSail sail;
  sail.scene = MakeSyntheticScene(options);
  sail.marker_id = sail.scene.x_in_world.rbegin()->first;
  const auto& x_in_world = sail.scene.x_in_world.at(sail.marker_id);
  sail.normal = (x_in_world[1] - x_in_world[3]).cross(x_in_world[2] - x_in_world[4]).normalized();
  for (std::size_t i = 0; i < sail.scene.frames.size(); ++i) {
    const Eigen::Vector3d shift =
        kFlap_m * std::sin(2 * 3.14159265358979 * static_cast<double>(i) / period) * sail.normal;
    for (MarkerDetection& marker : sail.scene.frames[i].markers) {
      if (marker.marker_id != sail.marker_id) continue;
      for (std::size_t corner = 0; corner < kNumCorners; ++corner) {
        marker.corners_in_image_px[corner] = *ImageFromCam(
            sail.scene.camera, sail.scene.cam_from_world[i] * (x_in_world[corner + 1] + shift));
      }
    }
  }
  AddNoise({0.1, 0, 0, 0, 3}, &sail.scene);
  return sail;
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

// Begins where the marker is at one end of its motion, as a registration may leave it that takes
// the other images for outliers.
TEST(MovingMarker, HasItsMeanPlaceAndASigmaThatContainsTheMotion) {
  const FlappingSail sail = Flap(11);
  Model model = MakeSceneModel(sail.scene);
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    model.points3D.at(Point3DIdFromCorner({sail.marker_id, corner})).x_in_world +=
        kFlap_m * sail.normal;
  }
  const MarkerAdjustmentSummary summary = AdjustWithMarkers({}, sail.scene.layout, {}, &model);
  double largest_m = 0.0, usual_sigma_m = 0.0;
  for (const auto& [marker_id, x_in_world] : sail.scene.x_in_world) {
    const CentreError found =
        CentreErrorOf(marker_id, sail.scene, model, summary.uncertainty.points);
    if (marker_id == sail.marker_id) {
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

}  // namespace
}  // namespace velamap
