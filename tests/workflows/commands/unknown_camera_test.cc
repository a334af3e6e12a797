// Whole jobs without a calibration.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "exporters/formats/shape_csv.h"
#include "exporters/shape/shape_metrics.h"
#include "importer/camera/calibration.h"
#include "importer/camera/calibration_writer.h"
#include "importer/database/colmap_database.h"
#include "tests/support/render/marker_renderer.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"
#include "tests/support/true_model.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class UnknownCameraTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    SyntheticSceneOptions options;
    options.num_rows = 3;
    options.num_columns = 4;
    options.num_frames = 12;
    options.camera = {CameraModel::kOpenCV, 960, 540, {700, 700, 484, 268, -0.05, 0.01, 0.0, 0.0}};
    scene_ = new SyntheticScene(MakeSyntheticScene(options));
    photos_ = new TempDir;
    RenderOptions rendering;
    rendering.supersampling = 2;
    rendering.noise_sigma = 1.0;
    for (int i = 0; i < options.num_frames; ++i) {
      rendering.seed = static_cast<std::uint32_t>(i + 1);
      cv::imwrite((photos_->path() / (std::to_string(i) + ".png")).string(),
                  RenderFrame(*scene_, i, rendering));
    }
  }
  static void TearDownTestSuite() {
    delete scene_;
    delete photos_;
  }

  ProgramRun Reconstruct(const std::string& workspace, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"automatic_reconstructor",
                                          "--image_path",
                                          photos_->path().string(),
                                          "--dictionary",
                                          scene_->layout.dictionary,
                                          "--marker_length",
                                          "0.1",
                                          "--workspace_path",
                                          (dir_.path() / workspace).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunVelamap(arguments);
  }

  double ShapeError(const std::string& workspace) {
    const MarkerShape shape =
        ReadShapeCsv((dir_.path() / workspace / "shape" / "shape.csv").string());
    return ComputeReferenceMetrics(shape, TrueShape(*scene_)).distance_m.rms;
  }

  static SyntheticScene* scene_;
  static TempDir* photos_;
  TempDir dir_;
};

SyntheticScene* UnknownCameraTest::scene_ = nullptr;
TempDir* UnknownCameraTest::photos_ = nullptr;

TEST_F(UnknownCameraTest, IsFoundAndServesTheNextRun) {
  const ProgramRun found = Reconstruct("found", {"--backend", "markers"});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("camera: found from the images, "));
  EXPECT_THAT(found.out, HasSubstr("camera.yml serves the next clip"));
  const fs::path camera_path = dir_.path() / "found" / "camera.yml";
  const Camera camera = ReadCalibration(camera_path.string());
  EXPECT_NEAR(MeanFocalLength(camera) / MeanFocalLength(scene_->camera), 1.0, 0.01);
  const auto shape =
      nlohmann::json::parse(ReadFileBytes(dir_.path() / "found" / "shape" / "shape.json"));
  EXPECT_EQ(shape.at("cameras").at(0).at("found_without_calibration"), true);
  // The database says that its camera is a guess.
  const ColmapDatabase database((dir_.path() / "found" / "database.db").string(),
                                ColmapDatabase::Mode::kReadOnly);
  EXPECT_FALSE(database.HasCalibration());

  const ProgramRun again =
      Reconstruct("again", {"--backend", "markers", "--camera_path", camera_path.string()});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_FALSE(fs::exists(dir_.path() / "again" / "camera.yml"));
  const double error_m = ShapeError("found");
  EXPECT_LT(error_m, 2e-3);
  EXPECT_LT(ShapeError("again"), 2 * error_m + 1e-4);

  // A calibration is no answer to a database that was made without one, nor the other way round.
  const ProgramRun mixed =
      Reconstruct("found", {"--backend", "markers", "--camera_path", camera_path.string()});
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_THAT(mixed.err, HasSubstr("was made without the calibration"));
  const ProgramRun without = Reconstruct("again", {"--backend", "markers"});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.err, HasSubstr("was made with a calibration"));
}

TEST_F(UnknownCameraTest, WishesThatNeedACalibrationAreRefused) {
  const ProgramRun colmap = Reconstruct("a", {"--backend", "colmap"});
  EXPECT_EQ(colmap.exit_code, 2);
  EXPECT_THAT(colmap.err, HasSubstr("--camera_path: missing; --backend colmap"));
  const fs::path prior = dir_.path() / "shape.csv";
  WriteTextFile(prior,
                "marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part\n"
                "1,1,0,0.1,0,,,,5,\n1,2,0.1,0.1,0,,,,5,\n1,3,0.1,0,0,,,,5,\n1,4,0,0,0,,,,5,\n");
  const ProgramRun with_prior =
      Reconstruct("b", {"--backend", "markers", "--prior_shape_path", prior.string()});
  EXPECT_EQ(with_prior.exit_code, 2);
  EXPECT_THAT(with_prior.err, HasSubstr("--prior_shape_path: says where markers are only with"));
}

// A camera that an earlier run has found is not that of a result with a calibration.
TEST_F(UnknownCameraTest, AFoundCameraDoesNotStayBesideAResultWithACalibration) {
  const EstimatedCamera estimate{scene_->camera,
                                 std::vector<double>(scene_->camera.params.size(), 0.5)};
  const std::string given = (dir_.path() / "given.yml").string();
  WriteCalibration(estimate, "of the board", given);
  const fs::path beside = dir_.path() / "known" / "camera.yml";
  const auto reconstruct = [&](const std::string& camera_path) {
    const ProgramRun run =
        Reconstruct("known", {"--backend", "markers", "--camera_path", camera_path,
                              "--ArucoDetection.estimate_formation", "0"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
  };
  reconstruct(given);
  EXPECT_FALSE(fs::exists(beside));
  WriteCalibration(estimate, "found by velamap 0.1 from 12 images of markers", beside.string());
  reconstruct(given);
  EXPECT_FALSE(fs::exists(beside));
  // Neither a file of the user, nor another calibration, nor the one that is given is removed.
  WriteTextFile(beside, "found by velamap, and then edited by hand");
  reconstruct(given);
  EXPECT_TRUE(fs::exists(beside));
  WriteCalibration(estimate, "velamap camera_calibrator: 20 views", beside.string());
  reconstruct(given);
  EXPECT_TRUE(fs::exists(beside));
  WriteCalibration(estimate, "found by velamap 0.1 from 12 images of markers", beside.string());
  reconstruct(beside.string());
  EXPECT_TRUE(fs::exists(beside));
}

}  // namespace
}  // namespace velamap
