#include "reconstruct/geometry/marker_pose.h"

#include <gtest/gtest.h>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

const Camera kCamera{
    CameraModel::kOpenCV, 1920, 1080, {1200, 1202, 957, 541, -0.1, 0.02, 4e-4, -3e-4}};

std::array<Eigen::Vector2d, kNumCorners> Project(const Rigid3& cam_from_marker, double length_m) {
  const auto corners = CornersInMarker(length_m);
  std::array<Eigen::Vector2d, kNumCorners> projected;
  for (int i = 0; i < kNumCorners; ++i) {
    projected[i] = *ImageFromCam(kCamera, cam_from_marker * corners[i]);
  }
  return projected;
}

// The face of an upright marker that looks at the camera: z of the marker points back to it.
Rigid3 FacingCamera(double tilt_rad, const Eigen::Vector3d& position) {
  const Eigen::Quaterniond face_on(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
  return {Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d(1, 2, 0).normalized()) * face_on, position};
}

TEST(MarkerPose, CornersRunClockwiseFromTopLeftSeenFromTheFront) {
  const auto corners_px = Project(FacingCamera(0, {0, 0, 2}), 0.1);
  EXPECT_LT(corners_px[0].x(), corners_px[1].x());  // top-left is left of top-right
  EXPECT_LT(corners_px[0].y(), corners_px[3].y());  // and above bottom-left
  EXPECT_LT(corners_px[3].x(), corners_px[2].x());
}

TEST(MarkerPose, NoiseFreePoseIsRecoveredAcrossTheImage) {
  for (const double tilt : {0.2, 0.6, 1.0}) {
    for (const Eigen::Vector3d& position :
         {Eigen::Vector3d(0.1, 0.2, 2), Eigen::Vector3d(-1.2, 0.6, 2.5)}) {
      const Rigid3 truth = FacingCamera(tilt, position);
      const auto poses = EstimateMarkerPoses(kCamera, Project(truth, 0.1), 0.1);
      ASSERT_FALSE(poses.empty());
      EXPECT_LT(AngularDistance(poses[0].cam_from_marker, truth), 1e-7);
      EXPECT_LT((poses[0].cam_from_marker.translation - truth.translation).norm(), 1e-9);
      EXPECT_LT(poses[0].rms_error_px, 1e-6);
    }
  }
}

TEST(MarkerPose, MarkerThatFacesTheCameraExactlyIsNoSpecialCase) {
  for (const Eigen::Vector3d& position :
       {Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(-0.6, 0.1, 2.6)}) {
    const Rigid3 truth = FacingCamera(0.0, position);
    const auto poses = EstimateMarkerPoses(kCamera, Project(truth, 0.1), 0.1);
    ASSERT_FALSE(poses.empty());
    EXPECT_LT(AngularDistance(poses[0].cam_from_marker, truth), 1e-4);
    EXPECT_LT((poses[0].cam_from_marker.translation - truth.translation).norm(), 1e-7);
  }
}

TEST(MarkerPose, BothSolutionsAreKeptBetterFirst) {
  const auto poses = EstimateMarkerPoses(kCamera, Project(FacingCamera(0.5, {0, 0, 5}), 0.1), 0.1);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_LE(poses[0].rms_error_px, poses[1].rms_error_px);
  EXPECT_GT(AngularDistance(poses[0].cam_from_marker, poses[1].cam_from_marker), 0.1);
}

TEST(MarkerPose, DistanceScalesWithTheLength) {
  const auto corners_px = Project(FacingCamera(0.5, {0.1, 0.1, 2}), 0.1);
  const auto poses = EstimateMarkerPoses(kCamera, corners_px, 0.2);
  EXPECT_NEAR(poses[0].cam_from_marker.translation.z(), 4.0, 1e-8);
}

}  // namespace
}  // namespace velamap
