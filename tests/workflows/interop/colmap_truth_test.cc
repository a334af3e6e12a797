// From exact detections through registration and the installed COLMAP back to the truth.

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <Eigen/Dense>

#include "importer/geometry/alignment.h"
#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/register_frames.h"
#include "reconstruct/seed_model.h"
#include "tests/workflows/interop/colmap_tools.h"

namespace velamap {
namespace {

struct Case {
  SceneKind kind;
  bool video;
};

std::string CaseName(const Case& parameters) {
  return std::string(parameters.kind == SceneKind::kCube ? "Cube" : "Sail") +
         (parameters.video ? "Video" : "Photographs");
}

// GoogleTest would print the bytes, and ctest make them part of the test's name.
void PrintTo(const Case& parameters, std::ostream* out) { *out << CaseName(parameters); }

SyntheticScene MakeScene(const Case& parameters, double corner_sigma_px) {
  SyntheticSceneOptions options;
  options.kind = parameters.kind;
  options.video = parameters.video;
  options.num_frames = 24;
  if (options.kind == SceneKind::kCube) options.num_rows = options.num_columns = 3;
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({corner_sigma_px, 0.0, 0.0, 0.0, 1}, &scene);
  return scene;
}

Eigen::Vector3d TruePoint(const SyntheticScene& scene, Point3DId point3D_id) {
  const CornerId id = CornerFromPoint3DId(point3D_id);
  return scene.x_in_world.at(id.marker_id)[static_cast<std::size_t>(id.corner)];
}

const Rigid3& TrueCamera(const SyntheticScene& scene, ImageId image_id) {
  return scene.cam_from_world.at(image_id - 1);
}

struct PointErrors {
  double rms_m = 0.0;
  double max_m = 0.0;
  double size_m = 0.0;  // root mean square distance of the true points from their centre
};

// Against the truth up to a similarity.
PointErrors ComparePoints(const Model& model, const SyntheticScene& scene) {
  std::vector<Eigen::Vector3d> x_in_model, x_in_truth;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const auto& [point3D_id, point] : model.points3D) {
    x_in_model.push_back(point.x_in_world);
    x_in_truth.push_back(TruePoint(scene, point3D_id));
    center += x_in_truth.back();
  }
  const double num_points = static_cast<double>(x_in_truth.size());
  center /= num_points;
  const Sim3 truth_from_model = EstimateSim3(x_in_model, x_in_truth);
  PointErrors errors;
  for (std::size_t i = 0; i < x_in_model.size(); ++i) {
    const double error_m = (truth_from_model * x_in_model[i] - x_in_truth[i]).norm();
    errors.max_m = std::max(errors.max_m, error_m);
    errors.rms_m += error_m * error_m;
    errors.size_m += (x_in_truth[i] - center).squaredNorm();
  }
  errors.rms_m = std::sqrt(errors.rms_m / num_points);
  errors.size_m = std::sqrt(errors.size_m / num_points);
  return errors;
}

using PointJacobian = Eigen::Matrix<double, 2, 3>;
using CameraJacobian = Eigen::Matrix<double, 2, 6>;

// Derivatives of the image position (px) by the point in world (m) and by a small motion of the
// camera (rad, m), from central differences.
std::pair<PointJacobian, CameraJacobian> Differentiate(const Camera& camera,
                                                       const Rigid3& cam_from_world,
                                                       const Eigen::Vector3d& x_in_world) {
  constexpr double kStep = 1e-5;
  const auto project = [&](const Eigen::Vector3d& x_in_cam) {
    return *ImageFromCam(camera, x_in_cam);
  };
  const Eigen::Vector3d x_in_cam = cam_from_world * x_in_world;
  PointJacobian by_x_in_cam;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
    by_x_in_cam.col(i) = (project(x_in_cam + step) - project(x_in_cam - step)) / (2 * kStep);
  }
  CameraJacobian by_motion;
  for (int i = 0; i < 3; ++i) {
    by_motion.col(i) = by_x_in_cam * Eigen::Vector3d::Unit(i).cross(x_in_cam);
  }
  by_motion.rightCols<3>() = by_x_in_cam;
  return {by_x_in_cam * cam_from_world.rotation.toRotationMatrix(), by_motion};
}

// Root mean square point error that a bundle adjustment has to be expected to have, to first order,
// after alignment of the points with the truth by a similarity: the trace of the points' covariance
// in the gauge that this alignment means, the pseudoinverse of the information on the points alone
// (inner constraints; Triggs et al., "Bundle adjustment - a modern synthesis", 2000, section 9).
double ExpectedRms(const Model& model, const SyntheticScene& scene, double corner_sigma_px) {
  std::map<ImageId, Eigen::Index> camera_row;
  for (const ModelImage& image : model.images) {
    camera_row.emplace(image.image_id, 6 * static_cast<Eigen::Index>(camera_row.size()));
  }
  const Eigen::Index num_point_rows = 3 * static_cast<Eigen::Index>(model.points3D.size());
  const Eigen::Index num_camera_rows = 6 * static_cast<Eigen::Index>(camera_row.size());
  Eigen::MatrixXd points = Eigen::MatrixXd::Zero(num_point_rows, num_point_rows);
  Eigen::MatrixXd cameras = Eigen::MatrixXd::Zero(num_camera_rows, num_camera_rows);
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(num_point_rows, num_camera_rows);
  Eigen::Index row = 0;
  for (const auto& [point3D_id, point] : model.points3D) {
    for (const TrackElement& element : point.track) {
      const auto [by_point, by_camera] = Differentiate(
          scene.camera, TrueCamera(scene, element.image_id), TruePoint(scene, point3D_id));
      const Eigen::Index column = camera_row.at(element.image_id);
      points.block<3, 3>(row, row) += by_point.transpose() * by_point;
      cameras.block<6, 6>(column, column) += by_camera.transpose() * by_camera;
      mixed.block<3, 6>(row, column) += by_point.transpose() * by_camera;
    }
    row += 3;
  }
  const Eigen::MatrixXd information = points - mixed * cameras.ldlt().solve(mixed.transpose());
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(information, Eigen::EigenvaluesOnly)
          .eigenvalues();
  // The seven smallest are the gauge's.
  constexpr Eigen::Index kGauge = 7;
  EXPECT_LT(eigenvalues[kGauge - 1], 1e-3 * eigenvalues[kGauge]);
  const double trace = eigenvalues.tail(num_point_rows - kGauge).cwiseInverse().sum();
  return corner_sigma_px * std::sqrt(trace / static_cast<double>(model.points3D.size()));
}

class ColmapTruthTest : public ColmapTest, public ::testing::WithParamInterface<Case> {
 protected:
  // Through a database, as the program goes.
  Model Reconstruct(const SyntheticScene& scene) const {
    WriteSceneDatabase(scene, path("database.db"));
    const ColmapDatabase database(path("database.db"), ColmapDatabase::Mode::kReadOnly);
    const std::vector<DatabaseImage> images = database.ReadImages();
    const std::map<CameraId, Camera> cameras = database.ReadCameras();
    Model model = MakeSeedModel(RegisterFrames(images, cameras, scene.layout, {}), images, cameras);
    AdjustWithColmap({}, path("colmap.log"), &model);
    return model;
  }
};

TEST_P(ColmapTruthTest, NoiseFreeDetectionsGiveTheTruth) {
  const SyntheticScene scene = MakeScene(GetParam(), 0.0);
  const Model model = Reconstruct(scene);
  EXPECT_GE(model.points3D.size(), 0.8 * 4 * scene.x_in_world.size());
  const PointErrors errors = ComparePoints(model, scene);
  EXPECT_LT(errors.max_m, 1e-6 * errors.size_m);
  RecordProperty("max_relative_error", testing::PrintToString(errors.max_m / errors.size_m));
}

// The expected error is a root mean square over all noise: a single draw of it, dominated by the
// few softest ways for the shape to bend, lies within a factor of two.
TEST_P(ColmapTruthTest, NoiseCostsWhatItHasTo) {
  constexpr double kSigmaPx = 0.3, kMaxRatio = 2.0;
  const SyntheticScene scene = MakeScene(GetParam(), kSigmaPx);
  const Model model = Reconstruct(scene);
  const double expected_m = ExpectedRms(model, scene, kSigmaPx);
  const PointErrors errors = ComparePoints(model, scene);
  EXPECT_LT(errors.rms_m, kMaxRatio * expected_m);
  EXPECT_GT(errors.rms_m, expected_m / kMaxRatio);
  RecordProperty("rms_mm", std::to_string(1e3 * errors.rms_m));
  RecordProperty("expected_rms_mm", std::to_string(1e3 * expected_m));
}

INSTANTIATE_TEST_SUITE_P(Scenes, ColmapTruthTest,
                         ::testing::Values(Case{SceneKind::kSail, true},
                                           Case{SceneKind::kSail, false},
                                           Case{SceneKind::kCube, true},
                                           Case{SceneKind::kCube, false}),
                         [](const auto& test) { return CaseName(test.param); });

}  // namespace
}  // namespace velamap
