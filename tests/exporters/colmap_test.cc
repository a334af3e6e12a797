// The metric model as the installed COLMAP reads it.

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <regex>

#include <gmock/gmock.h>

#include "reconstruct/colmap/colmap_runner.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/model_io.h"
#include "tests/exporters/example_model.h"
#include "tests/support/export_shape.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

class ExportToColmap : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v colmap > /dev/null 2>&1") != 0) {
      GTEST_SKIP() << "colmap is not on the PATH";
    }
    Model model = ExampleModel();
    AddImageNoise(1.0, 11, &model);
    // Tracks of two images make the mean over points differ from the mean over observations.
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const Point3DId id = Point3DIdFromCorner({2, corner});
      RemoveObservation(&model, id, model.points3D.at(id).track.back());
    }
    TransformModel(ExampleSim3(0.01), &model);
    for (auto& [id, point] : model.points3D) point.mean_error_px = 123.0;  // stale
    ShapeExporterOptions options;
    options.model_output_path = dir_ / "0";
    report_ = ExportShape(model, ExampleLayout(), options);
  }

  std::string Run(const std::vector<std::string>& arguments) {
    return RunColmap("colmap", arguments, dir_ / "colmap.log");
  }

  // The number after "key: " in the output of model_analyzer.
  static double Value(const std::string& output, const std::string& key) {
    std::smatch match;
    if (!std::regex_search(output, match, std::regex(key + ": ([-+.e0-9]+)"))) {
      ADD_FAILURE() << "no '" << key << "' in " << output;
      return -1.0;
    }
    return std::stod(match[1]);
  }

  TempDir dir_;
  ShapeExportReport report_;
};

TEST_F(ExportToColmap, AnalyzerReportsOurNumbersForBothFormats) {
  fs::create_directories(dir_ / "text");
  for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"}) {
    fs::copy_file(dir_ / "0" / name, dir_ / "text" / name);
  }
  const Model model = ReadModel(dir_ / "0");
  double error_sum_px = 0.0;
  int num_observations = 0;
  for (const auto& [id, point] : model.points3D) {
    error_sum_px += point.mean_error_px;
    num_observations += static_cast<int>(point.track.size());
  }
  for (const char* folder : {"0", "text"}) {
    const std::string output = Run({"model_analyzer", "--path", dir_ / folder});
    EXPECT_EQ(Value(output, "Cameras"), 1);
    EXPECT_EQ(Value(output, "Images"), 3);
    EXPECT_EQ(Value(output, "Registered images"), 3);
    EXPECT_EQ(Value(output, "Points"), 32);
    EXPECT_EQ(Value(output, "Observations"), num_observations);
    EXPECT_EQ(num_observations, 3 * 32 - 4);
    // COLMAP prints six digits of the mean over points.
    EXPECT_NEAR(Value(output, "Mean reprojection error"), error_sum_px / 32, 1e-5);
  }
}

TEST_F(ExportToColmap, PointErrorsAreThoseOfTheImages) {
  const Model model = ReadModel(dir_ / "0");
  for (const auto& [id, point] : model.points3D) {
    double sum_px = 0.0;
    for (const TrackElement& element : point.track) {
      const ModelImage& image = *model.FindImage(element.image_id);
      const auto x_in_image_px =
          ImageFromCam(model.cameras.at(image.camera_id), image.cam_from_world * point.x_in_world);
      sum_px += (*x_in_image_px - image.points2D[element.point2D_idx].x_in_image_px).norm();
    }
    EXPECT_NEAR(point.mean_error_px, sum_px / point.track.size(), 1e-9) << id;
  }
  EXPECT_GT(report_.model_metrics.error_px.mean, 0.3);
}

TEST_F(ExportToColmap, ConverterMakesAPlyOfAllPointsInMetres) {
  Run({"model_converter", "--input_path", dir_ / "0", "--output_path", dir_ / "points",
       "--output_type", "PLY"});
  fs::path ply = dir_ / "points";
  if (!fs::exists(ply)) ply += ".ply";
  std::ifstream in(ply, std::ios::binary);
  std::string line;
  bool has_vertices = false;
  while (std::getline(in, line) && line != "end_header") {
    has_vertices = has_vertices || line == "element vertex 32";
  }
  EXPECT_TRUE(has_vertices);
  // Rows start with x y z as floats. Distances between rows do not depend on their order.
  constexpr int kRowBytes = 3 * 4 + 3;
  std::vector<Eigen::Vector3f> points;
  char row[kRowBytes];
  while (in.read(row, kRowBytes)) {
    points.emplace_back();
    std::memcpy(points.back().data(), row, 3 * sizeof(float));
  }
  ASSERT_EQ(points.size(), 32u);
  const auto diameter = [](const auto& xs) {
    double largest = 0.0;
    for (const auto& a : xs) {
      for (const auto& b : xs) largest = std::max(largest, double((a - b).norm()));
    }
    return largest;
  };
  std::vector<Eigen::Vector3d> corners;
  for (const ShapeMarker& marker : report_.shape.markers) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      corners.push_back(*marker.x_in_shape_m[corner]);
    }
  }
  EXPECT_NEAR(diameter(points), diameter(corners), 1e-5);
}

}  // namespace
}  // namespace velamap
