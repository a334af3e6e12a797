// From rendered pictures of a sail, whose truth is known, to shape.csv.

#include <algorithm>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "exporters/formats/shape_csv.h"
#include "exporters/shape/shape_metrics.h"
#include "importer/database/colmap_database.h"
#include "importer/geometry/quad.h"
#include "tests/support/render/marker_renderer.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"
#include "tests/support/true_model.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
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
  options.supersampling = 2;
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

constexpr int kNumBare = 3;

// The marker is painted over in the first frames; then a dark thread hangs from the middle of its
// lower side, so that its outline is no quadrilateral and the detector passes over it.
std::vector<cv::Mat> WithThread(const SyntheticScene& scene, std::vector<cv::Mat> frames,
                                int marker_id) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (const MarkerDetection& marker : scene.frames[i].markers) {
      if (marker.marker_id != marker_id) continue;
      const auto& corners = marker.corners_in_image_px;
      if (i < kNumBare) {
        const Eigen::Vector2d center = CornerMean(marker);
        cv::circle(frames[i], cv::Point2d(center.x(), center.y()),
                   cvCeil(0.9 * (corners[0] - corners[1]).norm()), cv::Scalar::all(200),
                   cv::FILLED);
        continue;
      }
      const Eigen::Vector2d from = 0.5 * (corners[2] + corners[3]);
      const Eigen::Vector2d to = from + 0.4 * (from - 0.5 * (corners[0] + corners[1]));
      cv::line(frames[i], cv::Point2d(from.x(), from.y()), cv::Point2d(to.x(), to.y()),
               cv::Scalar::all(40), 3);
    }
  }
  return frames;
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

  ProgramRun Reconstruct(const fs::path& image_path) {
    return Run("automatic_reconstructor", image_path,
               {"--workspace_path", (dir_ / "workspace").string()});
  }

  ProgramRun Import(const fs::path& image_path, const std::string& database,
                    const std::string& prior_shape_path = "") {
    std::vector<std::string> options = {"--database_path", (dir_ / database).string()};
    if (!prior_shape_path.empty()) {
      options.insert(options.end(), {"--prior_shape_path", prior_shape_path});
    }
    return Run("marker_importer", image_path, options);
  }

  ProgramRun Run(const std::string& command, const fs::path& image_path,
                 const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {command,
                                          "--image_path",
                                          image_path.string(),
                                          "--camera_path",
                                          (dir_ / "cameras.txt").string(),
                                          "--dictionary",
                                          scene_->layout.dictionary,
                                          "--marker_length",
                                          std::to_string(kMarkerLengthM)};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return RunVelamap(arguments);
  }

  fs::path WritePhotos(const std::string& name, const std::vector<cv::Mat>& photos) {
    fs::create_directory(dir_ / name);
    for (std::size_t i = 0; i < photos.size(); ++i) {
      cv::imwrite((dir_ / name / (std::to_string(i) + ".png")).string(), photos[i]);
    }
    return dir_ / name;
  }

  std::string WriteVideo(const std::string& name, const std::vector<cv::Mat>& frames) {
    cv::VideoWriter writer(dir_ / name, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                           frames[0].size());
    EXPECT_TRUE(writer.isOpened());
    for (const cv::Mat& frame : frames) writer.write(frame);
    return dir_ / name;
  }

  // The error of one marker in each image: that of its worst corner.
  std::map<std::string, double> ErrorsOf(int marker_id, const std::string& database) {
    std::map<std::string, double> errors_px;
    std::size_t frame_idx = 0;
    for (const DatabaseImage& image :
         ColmapDatabase(dir_ / database, ColmapDatabase::Mode::kReadOnly).ReadImages()) {
      const auto is_it = [=](const MarkerDetection& m) { return m.marker_id == marker_id; };
      const auto& markers = image.detections.markers;
      const auto& truths = scene_->frames[frame_idx++].markers;
      const auto found = std::find_if(markers.begin(), markers.end(), is_it);
      const auto truth = std::find_if(truths.begin(), truths.end(), is_it);
      if (found == markers.end() || truth == truths.end()) continue;
      errors_px[image.detections.image_name] =
          MaxCornerShift(found->corners_in_image_px, truth->corners_in_image_px);
    }
    return errors_px;
  }

  void ExpectTrueShape(double max_rms_m) {
    const ReferenceMetrics comparison = ComputeReferenceMetrics(
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
  WritePhotos("photos", *frames_);
  WriteTextFile(dir_ / "photos/broken.png", "no picture");
  const ProgramRun run = Reconstruct(dir_ / "photos");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("images left out: 1: "));
  EXPECT_THAT(run.out, HasSubstr("images: 12 of 13 used, "));
  ExpectTrueShape(0.0005);

  const std::string first = ReadFileBytes(dir_ / "workspace/shape/shape.csv");
  ASSERT_EQ(Reconstruct(dir_ / "photos").exit_code, 0);
  EXPECT_EQ(ReadFileBytes(dir_ / "workspace/shape/shape.csv"), first);
}

TEST_F(RenderedPicturesTest, VideoGivesTheTrueShape) {
  const ProgramRun run = Reconstruct(WriteVideo("sail.avi", *frames_));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ExpectTrueShape(0.0005);
  // images/ holds the frames of the model and no others.
  const std::string used =
      "images: " + std::to_string(ListFolder(dir_ / "workspace/images").size());
  EXPECT_THAT(run.out, HasSubstr(used + " of 12 used, "));
}

TEST_F(RenderedPicturesTest, PriorShapeFindsWhatTheDetectorMisses) {
  ASSERT_EQ(Reconstruct(WritePhotos("photos", *frames_)).exit_code, 0);
  const std::string shape = (dir_ / "workspace/shape").string();
  const int marker_id = scene_->x_in_world.begin()->first;
  const std::vector<cv::Mat> frames = WithThread(*scene_, *frames_, marker_id);
  for (const fs::path& input :
       {WritePhotos("with_thread", frames), fs::path(WriteVideo("with_thread.avi", frames))}) {
    const std::string name = input.filename().string();
    const ProgramRun without = Import(input, name + "_without.db");
    ASSERT_EQ(without.exit_code, 0) << without.err;
    EXPECT_THAT(without.out, HasSubstr("\nmarkers: 132\n"));
    EXPECT_THAT(without.out, Not(HasSubstr("_prior_shape: ")));
    const ProgramRun with = Import(input, name + ".db", shape);
    ASSERT_EQ(with.exit_code, 0) << with.err;
    EXPECT_THAT(with.out, HasSubstr("\nmarkers: 141\n"));
    EXPECT_THAT(with.out, HasSubstr("\nmarkers_agreeing_with_prior_shape: 1"));
    const auto errors_px = ErrorsOf(marker_id, name + ".db");
    EXPECT_EQ(errors_px.size(), frames.size() - kNumBare);
    for (const auto& [image_name, error_px] : errors_px) {
      EXPECT_LT(error_px, 1.0) << image_name;
    }
  }
}

TEST_F(RenderedPicturesTest, PriorShapeOfAnotherSurfaceIsWarnedOf) {
  MarkerShape shuffled = TrueShape(*scene_);
  for (ShapeMarker& marker : shuffled.markers) marker.marker_id = 11 - marker.marker_id;
  std::ostringstream csv;
  WriteShapeCsv(shuffled, csv);
  WriteTextFile(dir_ / "other.csv", csv.str());
  const fs::path photos = WritePhotos("photos", *frames_);
  const ProgramRun run = Import(photos, "database.db", dir_ / "other.csv");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("the prior shape does not fit these images"));
  EXPECT_THAT(run.out, HasSubstr("markers_agreeing_with_prior_shape: 0\n"));

  const ProgramRun nothing_new = Import(photos, "database.db", dir_ / "other.csv");
  EXPECT_EQ(nothing_new.exit_code, 0) << nothing_new.err;
  EXPECT_THAT(nothing_new.err, Not(HasSubstr("--prior_shape_path")));

  const ProgramRun again = Import(photos, "database.db");
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("another prior shape"));
}

}  // namespace
}  // namespace velamap
