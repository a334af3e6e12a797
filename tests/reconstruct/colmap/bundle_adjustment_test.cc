#include "reconstruct/colmap/bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <set>

#include <gmock/gmock.h>

#include "importer/base/error.h"
#include "reconstruct/colmap/colmap_runner.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/model/reprojection.h"
#include "tests/reconstruct/sheet_model.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

class BundleAdjustment : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v colmap > /dev/null 2>&1") != 0) {
      GTEST_SKIP() << "colmap is not on the PATH";
    }
  }

  BundleAdjustmentSummary Adjust(Model* model, const BundleAdjustmentOptions& options = {}) {
    return AdjustWithColmap(options, dir_ / "colmap.log", model);
  }

  TempDir dir_;
  const Model truth_ = MakeSheetModel();
};

TEST_F(BundleAdjustment, NoiseFreeTruthComesBack) {
  Model model = truth_;
  PerturbSeed(0.01, 1, &model);
  const auto summary = Adjust(&model);
  EXPECT_GT(summary.error_before_px.mean, 10);
  EXPECT_LT(summary.error_after_px.max, 1e-6);
  EXPECT_LT(MaxPointError(model, truth_), 1e-6);
  EXPECT_THAT(summary.removed, IsEmpty());
  EXPECT_THAT(summary.removed_images, IsEmpty());
  EXPECT_EQ(summary.num_rounds, 1);
  EXPECT_EQ(model.cameras, truth_.cameras);
}

TEST_F(BundleAdjustment, WorldAndOrderAreThoseOfTheGauge) {
  Model model = truth_;
  PerturbSeed(0.01, 1, &model);
  std::swap(model.images[0], model.images[4]);
  const ImageId first = model.images[0].image_id;
  Adjust(&model);
  CheckModel(model);
  EXPECT_EQ(model.images[0].image_id, first);
  EXPECT_EQ(model.images[0].cam_from_world.translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(model.images[0].cam_from_world.rotation.w(), 1.0);
  Model ordered = model;
  OrderForGauge(first, &ordered);
  EXPECT_EQ(Bytes(model), Bytes(ordered));
  // Everything else of the images and points is as it was.
  for (const ModelImage& image : model.images) {
    EXPECT_EQ(image.name, truth_.FindImage(image.image_id)->name);
    EXPECT_EQ(image.points2D.size(), truth_.FindImage(image.image_id)->points2D.size());
  }
  EXPECT_EQ(model.points3D.at(11).color, truth_.points3D.at(11).color);
}

TEST_F(BundleAdjustment, NoisyErrorsAreTrueAndOfTheNoise) {
  Model model = truth_;
  AddImageNoise(0.3, 2, &model);
  PerturbSeed(0.01, 1, &model);
  const auto summary = Adjust(&model);
  // 1440 residuals determine 294 parameters less 7 of the gauge.
  EXPECT_NEAR(summary.error_after_px.rms / std::sqrt(2.0), 0.3 * std::sqrt(1.0 - 287.0 / 1440.0),
              0.02);
  EXPECT_LT(MaxPointError(model, truth_), 5e-3);
  Model updated = model;
  UpdatePointErrors(&updated);
  EXPECT_EQ(Bytes(updated), Bytes(model));
}

TEST_F(BundleAdjustment, OrderOfTheImagesDecidesTheLastDigitsOnly) {
  Model model = truth_;
  AddImageNoise(0.3, 2, &model);
  PerturbSeed(0.01, 1, &model);
  Model shuffled = model;
  std::reverse(shuffled.images.begin() + 1, shuffled.images.end());
  Adjust(&model);
  Adjust(&shuffled);
  EXPECT_LT(MaxPointError(shuffled, model), 1e-9);
}

TEST_F(BundleAdjustment, GrossOutliersAreRemovedAndNothingElse) {
  Model model = truth_;
  AddImageNoise(0.3, 2, &model);
  Model clean = model;
  const auto outliers = AddOutliers(0.01, 3, &model);
  ASSERT_GT(outliers.size(), 4u);
  PerturbSeed(0.01, 1, &model);
  const auto summary = Adjust(&model);
  std::set<std::pair<Point3DId, ImageId>> expected, removed;
  for (const auto& [point3D_id, element] : outliers) {
    expected.emplace(point3D_id, element.image_id);
  }
  for (const RemovedObservation& observation : summary.removed) {
    removed.emplace(observation.point3D_id, observation.element.image_id);
    EXPECT_GT(observation.error_px, 0.5);
  }
  EXPECT_EQ(removed, expected);
  CheckModel(model);
  EXPECT_EQ(model.points3D.size(), truth_.points3D.size());
  EXPECT_LT(summary.error_after_px.max, 3);

  Adjust(&clean);
  EXPECT_LT(MaxPointError(model, clean), 2e-3) << "as if the outliers had not been there";
}

TEST_F(BundleAdjustment, AloneItLeavesNothingOut) {
  Model model = truth_;
  AddImageNoise(0.3, 2, &model);
  ASSERT_GT(AddOutliers(0.01, 3, &model).size(), 4u);
  PerturbSeed(0.01, 1, &model);
  BundleAdjustmentOptions options;
  options.remove_outliers = false;
  options.max_mean_error_px = 1e3;
  const auto summary = Adjust(&model, options);
  EXPECT_THAT(summary.removed, IsEmpty());
  EXPECT_EQ(summary.num_rounds, 1);
  EXPECT_GT(summary.error_after_px.max, 3);
}

TEST_F(BundleAdjustment, PointBehindAllCamerasIsRemoved) {
  Model model = truth_;
  PerturbSeed(0.01, 1, &model);
  model.points3D.at(11).x_in_world = {0, 0, 100};
  const auto summary = Adjust(&model);
  CheckModel(model);
  EXPECT_EQ(summary.removed.size(), 9u);
  EXPECT_EQ(model.points3D.count(11), 0u);
  EXPECT_EQ(model.points3D.size(), truth_.points3D.size() - 1);
  EXPECT_LT(MaxPointError(model, truth_), 1e-6);
}

TEST_F(BundleAdjustment, ObservationsFromBehindReturnOnceTheirPointIsRight) {
  Model model = truth_;
  PerturbSeed(0.01, 1, &model);
  model.points3D.at(11).x_in_world = {-100, 0, 5};
  const auto errors = ComputeReprojectionErrors(model);
  const auto num_behind = std::count_if(
      errors.begin(), errors.end(), [](const auto& error) { return std::isinf(error.error_px); });
  ASSERT_GT(num_behind, 0);
  ASSERT_LT(num_behind, 8);
  const auto summary = Adjust(&model);
  CheckModel(model);
  EXPECT_THAT(summary.removed, IsEmpty());
  EXPECT_EQ(model.points3D.at(11).track.size(), 9u);
  EXPECT_LT(MaxPointError(model, truth_), 1e-6);
}

TEST_F(BundleAdjustment, ImagesWithTooFewObservationsAreRemovedAndReported) {
  Model model = truth_;
  for (const Point3DId id : {11, 12, 13}) {
    for (int i = 0; i < 7; ++i) RemoveObservation(&model, id, model.points3D.at(id).track[0]);
  }
  // The last image sees three points; two of them then have no second view.
  for (auto& [point3D_id, point] : model.points3D) {
    if (point3D_id > 13) RemoveObservation(&model, point3D_id, point.track.back());
  }
  const ImageId last = model.points3D.at(11).track.back().image_id;
  const auto summary = Adjust(&model);
  CheckModel(model);
  EXPECT_THAT(summary.removed_images, ElementsAre(last));
  EXPECT_EQ(model.images.size(), 8u);
  EXPECT_EQ(model.points3D.size(), truth_.points3D.size() - 3);
  EXPECT_LT(MaxPointError(model, truth_), 1e-6);
}

TEST_F(BundleAdjustment, RefinedIntrinsicsAreTakenOver) {
  Model model = truth_;
  PerturbSeed(0.005, 1, &model);
  const std::vector<double> truth = truth_.cameras.at(1).params;
  model.cameras.at(1).params[0] *= 1.02;
  model.cameras.at(1).params[1] *= 0.99;
  model.cameras.at(1).params[4] = 0;
  const Model wrong = model;
  BundleAdjustmentOptions options;
  options.refine_focal_length = true;
  options.refine_extra_params = true;
  Adjust(&model, options);
  const std::vector<double>& refined = model.cameras.at(1).params;
  for (const std::size_t i : {0, 1}) EXPECT_NEAR(refined[i], truth[i], 1e-2);
  for (const std::size_t i : {4, 5, 6, 7}) EXPECT_NEAR(refined[i], truth[i], 1e-4);
  EXPECT_EQ(refined[2], truth[2]) << "the principal point is held";

  Model held = wrong;
  Adjust(&held);
  EXPECT_EQ(held.cameras, wrong.cameras);
}

TEST_F(BundleAdjustment, ParametersThatTheCalibrationDoesNotNameAreNotFreed) {
  Model model = truth_;
  Camera& camera = model.cameras.at(1);
  camera.model = CameraModel::kFullOpenCV;
  camera.params.resize(12, 0.0);
  camera.params[8] = 0.01;
  const std::string before = Bytes(model);
  BundleAdjustmentOptions options;
  options.refine_extra_params = true;
  ExpectThrows<InputError>([&] { Adjust(&model, options); },
                           {"--BundleAdjustment.refine_extra_params", "--backend markers"});
  EXPECT_EQ(Bytes(model), before);
}

TEST_F(BundleAdjustment, TooLittleIsADataError) {
  Model single = truth_;
  while (single.images.size() > 1) {
    for (auto& [point3D_id, point] : single.points3D) point.track.pop_back();
    single.images.pop_back();
  }
  const std::string before = Bytes(single);
  EXPECT_THROW(Adjust(&single), DataError);
  EXPECT_EQ(Bytes(single), before) << "the model stays as it was";
  Model empty;
  EXPECT_THROW(Adjust(&empty), DataError);
}

TEST_F(BundleAdjustment, ErrorsAboveTheLimitAreADataError) {
  Model model = truth_;
  AddImageNoise(3.0, 2, &model);
  BundleAdjustmentOptions options;
  options.max_mean_error_px = 2.0;
  ExpectThrows<DataError>([&] { Adjust(&model, options); }, {"--BundleAdjustment.max_mean_error"});
}

// COLMAP 3.8 fixes x of the second image's translation. Where its true value is zero, an error of
// the seed fixes a wrong value, and only an infinite scale makes up for it.
class GaugeTrap : public BundleAdjustment {
 protected:
  struct Run {
    Model model;
    int num_iterations = 0;
  };

  Run RunBundleAdjuster(const Model& model) {
    fs::remove_all(dir_ / "out");
    fs::create_directory(dir_ / "out");
    WriteModel(model, dir_ / "in", ModelFormat::kBinary);
    const std::string output = RunColmap(
        "colmap",
        {"bundle_adjuster", "--input_path", dir_ / "in", "--output_path", dir_ / "out",
         "--BundleAdjustment.function_tolerance", "1e-6", "--BundleAdjustment.refine_focal_length",
         "0", "--BundleAdjustment.refine_extra_params", "0"},
        dir_ / "colmap.log");
    std::smatch match;
    EXPECT_TRUE(std::regex_search(output, match, std::regex("Iterations : ([0-9]+)"))) << output;
    return {ReadModel(dir_ / "out"), match.empty() ? 0 : std::stoi(match[1])};
  }

  static double Size(const Model& model) {
    return (model.points3D.at(11).x_in_world - model.points3D.at(203).x_in_world).norm();
  }
};

TEST_F(GaugeTrap, OrderingForTheGaugeAvoidsIt) {
  Model model = truth_;
  OrderForGauge(1, &model);
  ModelImage& above = model.images.back();
  above.cam_from_world.translation.x() = 0;
  for (Point2D& point2D : above.points2D) {
    point2D.x_in_image_px =
        ImageFromCam(model.cameras.at(1),
                     above.cam_from_world * model.points3D.at(point2D.point3D_id).x_in_world)
            .value();
  }
  AddImageNoise(0.3, 2, &model);
  const double true_size = Size(model);
  PerturbSeed(0.01, 1, &model);
  Model trapped = model;
  std::swap(trapped.images[1], trapped.images.back());
  OrderForGauge(1, &model);

  const Run good = RunBundleAdjuster(model);
  const Run bad = RunBundleAdjuster(trapped);
  EXPECT_LT(good.num_iterations, 20);
  EXPECT_NEAR(Size(good.model) / true_size, 1.0, 0.1);
  EXPECT_GT(bad.num_iterations, 2 * good.num_iterations);
  EXPECT_GT(Size(bad.model) / true_size, 10.0);
}

}  // namespace
}  // namespace velamap
