// From rendered pictures of a sail, whose truth is known, to shape.csv.

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "exporters/shape_csv.h"
#include "exporters/shape_metrics.h"
#include "tests/support/marker_renderer.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double kMarkerLengthM = 0.1;

SyntheticScene MakeSail() {
  SyntheticSceneOptions options;
  options.kind = SceneKind::kSail;
  options.num_rows = 3;
  options.num_columns = 4;
  options.marker_length_m = kMarkerLengthM;
  options.num_frames = 12;
  options.camera = {CameraModel::kOpenCV, 960, 540, {700, 700, 480, 270, -0.05, 0.01, 0.0, 0.0}};
  return MakeSyntheticScene(options);
}

std::vector<cv::Mat> RenderAll(const SyntheticScene& scene) {
  RenderOptions options;
  options.supersampling = 4;
  options.noise_sigma = 1.0;
  std::vector<cv::Mat> frames;
  for (int i = 0; i < static_cast<int>(scene.frames.size()); ++i) {
    options.seed = static_cast<std::uint32_t>(i + 1);
    cv::Mat color;
    cv::cvtColor(RenderFrame(scene, i, options), color, cv::COLOR_GRAY2BGR);
    frames.push_back(color);
  }
  return frames;
}

MarkerShape TrueShape(const SyntheticScene& scene) {
  MarkerShape shape;
  for (const auto& [marker_id, points] : scene.x_in_world) {
    ShapeMarker marker;
    marker.marker_id = marker_id;
    for (std::size_t i = 0; i < points.size(); ++i) marker.x_in_shape_m[i] = points[i];
    shape.markers.push_back(marker);
  }
  return shape;
}

class RenderedPicturesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene_ = new SyntheticScene(MakeSail());
    frames_ = new std::vector<cv::Mat>(RenderAll(*scene_));
  }
  static void TearDownTestSuite() {
    delete scene_;
    delete frames_;
  }

  void SetUp() override {
    const Camera& camera = scene_->camera;
    std::ostringstream line;
    line << "1 " << CameraModelName(camera.model) << ' ' << camera.width_px << ' '
         << camera.height_px;
    for (const double param : camera.params) line << ' ' << param;
    WriteTextFile(dir_ / "cameras.txt", line.str() + "\n");
  }

  ProgramRun Reconstruct(const fs::path& image_path, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"automatic_reconstructor",
                                          "--image_path",
                                          image_path.string(),
                                          "--camera_path",
                                          (dir_ / "cameras.txt").string(),
                                          "--dictionary",
                                          scene_->layout.dictionary,
                                          "--marker_length",
                                          std::to_string(kMarkerLengthM),
                                          "--workspace_path",
                                          (dir_ / "workspace").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunVelamap(arguments);
  }

  void ExpectTrueShape(double max_rms_m) {
    const ShapeComparison comparison = CompareShapes(
        ReadShapeCsv((dir_ / "workspace/shape/shape.csv").string()), TrueShape(*scene_));
    EXPECT_EQ(comparison.num_points, 4 * static_cast<int>(scene_->x_in_world.size()));
    EXPECT_LT(comparison.distance_m.rms, max_rms_m);
  }

  static SyntheticScene* scene_;
  static std::vector<cv::Mat>* frames_;
  TempDir dir_;
};

SyntheticScene* RenderedPicturesTest::scene_ = nullptr;
std::vector<cv::Mat>* RenderedPicturesTest::frames_ = nullptr;

TEST_F(RenderedPicturesTest, PhotographsGiveTheTrueShape) {
  fs::create_directory(dir_ / "photos");
  for (std::size_t i = 0; i < frames_->size(); ++i) {
    cv::imwrite((dir_ / ("photos/" + std::to_string(i) + ".png")).string(), (*frames_)[i]);
  }
  WriteTextFile(dir_ / "photos/broken.png", "no picture");
  const ProgramRun run = Reconstruct(dir_ / "photos");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("images_used: 12 of 13\nimages_left_out: 1; 1: "));
  EXPECT_THAT(run.out, HasSubstr("markers_reconstructed: 12\n"));
  ExpectTrueShape(0.0005);

  const std::string first = ReadFileBytes(dir_ / "workspace/shape/shape.csv");
  ASSERT_EQ(Reconstruct(dir_ / "photos").exit_code, 0);
  EXPECT_EQ(ReadFileBytes(dir_ / "workspace/shape/shape.csv"), first);
}

TEST_F(RenderedPicturesTest, VideoGivesTheTrueShape) {
  const std::string video = (dir_ / "sail.avi").string();
  {
    cv::VideoWriter writer(video, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                           (*frames_)[0].size());
    ASSERT_TRUE(writer.isOpened());
    for (const cv::Mat& frame : *frames_) writer.write(frame);
  }
  const ProgramRun run = Reconstruct(video);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ExpectTrueShape(0.0005);
  // images/ holds the frames of the model and no others.
  const std::string used =
      "images_used: " + std::to_string(ListFolder(dir_ / "workspace/images").size());
  EXPECT_THAT(run.out, HasSubstr(used + " of 12\n"));
}

}  // namespace
}  // namespace velamap
