// The goals on real pictures: the samples and a video, reconstructed by the real program.

#include <algorithm>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/formats/shape_csv.h"
#include "exporters/shape/part_planes.h"
#include "exporters/shape/shape_metrics.h"
#include "reconstruct/model/model_io.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path kCube = fs::path(VELAMAP_SOURCE_DIR) / "sample_project/cube";
const fs::path kStylus = fs::path(VELAMAP_SOURCE_DIR) / "sample_project/stylus";
const fs::path kAprilGrid = fs::path(VELAMAP_SOURCE_DIR) / "tests/data/aprilgrid";
const fs::path kBoardVideo = fs::path(VELAMAP_SOURCE_DIR) / "tests/data/board_video";

// Pictures from `image_path`, calibration and layout from the folder of the sample.
ProgramRun Reconstruct(const fs::path& sample, const fs::path& image_path,
                       const fs::path& workspace, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"automatic_reconstructor",
                                        "--image_path",
                                        image_path.string(),
                                        "--camera_path",
                                        (sample / "camera.yml").string(),
                                        "--layout_path",
                                        (sample / "layout.yml").string(),
                                        "--workspace_path",
                                        workspace.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return RunVelamap(arguments);
}

int NumWholeMarkers(const MarkerShape& shape) {
  return static_cast<int>(
      std::count_if(shape.markers.begin(), shape.markers.end(),
                    [](const ShapeMarker& marker) { return marker.IsWhole(); }));
}

int NumCorners(const MarkerShape& shape) {
  int num_corners = 0;
  for (const ShapeMarker& marker : shape.markers) {
    num_corners +=
        static_cast<int>(std::count_if(marker.x_in_shape_m.begin() + 1, marker.x_in_shape_m.end(),
                                       [](const auto& corner) { return corner.has_value(); }));
  }
  return num_corners;
}

std::string Text(double value) { return fmt::format("{:.5g}", value); }

ShapeComparison CompareWithReference(const fs::path& sample, const MarkerShape& shape) {
  return CompareShapes(shape, ReadShapeCsv((sample / "reference.csv").string()));
}

void ExpectFlatFaces(const std::vector<PartPlane>& planes) {
  ASSERT_EQ(planes.size(), 6u);
  for (const PartPlane& plane : planes) {
    EXPECT_LT(plane.corner_distance_mm.rms, 0.06) << plane.part;
    EXPECT_GE(plane.num_markers, 28) << plane.part;
    testing::Test::RecordProperty(plane.part + "_rms_um", Text(1e3 * plane.corner_distance_mm.rms));
  }
}

void ExpectFacesOfACube(const std::vector<PartPlane>& planes) {
  int num_opposite = 0, num_neighbors = 0;
  for (const PlanePair& pair : ComparePlanes(planes)) {
    const std::string name = pair.part1 + "_" + pair.part2;
    testing::Test::RecordProperty(name,
                                  Text(pair.angle_deg) + " deg, " + Text(pair.distance_mm) + " mm");
    if (pair.angle_deg < 135) {
      ++num_neighbors;
      EXPECT_NEAR(pair.angle_deg, 90, 1) << name;
    } else {
      ++num_opposite;
      EXPECT_GT(pair.angle_deg, 180 - 0.6) << name;
      EXPECT_GE(pair.distance_mm, 39.95) << name;
      EXPECT_LE(pair.distance_mm, 40.4) << name;
    }
  }
  EXPECT_EQ(num_opposite, 3);
  EXPECT_EQ(num_neighbors, 12);
}

// One test, because each runs in a process of its own and would reconstruct the cube again.
TEST(CubeTest, ReachesTheGoals) {
  const TempDir dir;
  const ProgramRun run = Reconstruct(kCube, kCube / "images", dir / "cube");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Model model = ReadModel((dir / "cube/sparse/0").string());
  const MarkerShape shape = ReadShapeCsv((dir / "cube/shape/shape.csv").string());
  EXPECT_GE(model.images.size(), 22u);
  EXPECT_GE(NumWholeMarkers(shape), 240);
  const std::vector<PartPlane> planes = FitPartPlanes(shape);
  ExpectFlatFaces(planes);
  ExpectFacesOfACube(planes);
}

// The order decides which of two equally good pairs of photographs the map starts from, and so
// which of the markers at the edge of what can be seen are kept.
TEST(CubeTest, NamesAndOrderOfThePhotographsHardlyChangeTheShape) {
  const TempDir dir;
  std::vector<std::string> names = ListFolder(kCube / "images");
  std::shuffle(names.begin(), names.end(), std::mt19937(7));
  fs::create_directory(dir / "photos");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name = "photos/picture" + std::to_string(i + 1) + ".jpg";
    fs::copy_file(kCube / "images" / names[i], dir / name);
  }
  const ProgramRun run = Reconstruct(kCube, kCube / "images", dir / "cube");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const ProgramRun renamed_run = Reconstruct(kCube, dir / "photos", dir / "renamed");
  ASSERT_EQ(renamed_run.exit_code, 0) << renamed_run.err;
  const MarkerShape shape = ReadShapeCsv((dir / "cube/shape/shape.csv").string());
  const MarkerShape renamed = ReadShapeCsv((dir / "renamed/shape/shape.csv").string());
  EXPECT_NEAR(NumWholeMarkers(renamed), NumWholeMarkers(shape), 0.05 * NumWholeMarkers(shape));
  const ShapeComparison comparison = CompareShapes(renamed, shape);
  EXPECT_GE(comparison.num_points, 0.95 * NumCorners(shape));
  EXPECT_LT(comparison.distance_m.rms, 1e-5);
  EXPECT_NEAR(comparison.scale, 1.0, 2e-4);
  RecordProperty("max_distance_um", Text(1e6 * comparison.distance_m.max));
  RecordProperty("scale_error_ppb", Text(1e9 * (comparison.scale - 1)));
}

TEST(StylusTest, AllMarkersComeNearTheDesign) {
  const TempDir dir;
  const ProgramRun run = Reconstruct(kStylus, kStylus / "images", dir / "stylus");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const MarkerShape shape = ReadShapeCsv((dir / "stylus/shape/shape.csv").string());
  EXPECT_EQ(NumWholeMarkers(shape), 8);
  const ShapeComparison comparison = CompareWithReference(kStylus, shape);
  EXPECT_EQ(comparison.num_points, 32);
  EXPECT_LE(comparison.distance_m.rms, 0.0006);
  RecordProperty("rms_mm", Text(1e3 * comparison.distance_m.rms));
}

// Its corners are saddle points, which stay where they are when ink spreads; its sides do not.
TEST(AprilGridTest, ScaleIsThatOfTheLayout) {
  const TempDir dir;
  const fs::path workspace = dir / "workspace";
  const ProgramRun run = Reconstruct(kAprilGrid, kAprilGrid / "images", workspace);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const MarkerShape shape = ReadShapeCsv((workspace / "shape/shape.csv").string());
  EXPECT_EQ(NumWholeMarkers(shape), 20);
  const ShapeComparison comparison = CompareWithReference(kAprilGrid, shape);
  EXPECT_EQ(comparison.num_points, 80);
  EXPECT_NEAR(comparison.scale, 1.0, 1e-3);
  EXPECT_LE(comparison.distance_m.rms, 0.25e-3);
  RecordProperty("scale", Text(comparison.scale));
  RecordProperty("rms_mm", Text(1e3 * comparison.distance_m.rms));
}

class BoardVideoTest : public ::testing::Test {
 protected:
  ProgramRun Run(const std::vector<std::string>& more) const {
    return Reconstruct(kBoardVideo, kBoardVideo / "cam_0.mp4", workspace(), more);
  }
  fs::path workspace() const { return dir_ / "workspace"; }

  TempDir dir_;
};

TEST_F(BoardVideoTest, InvertedPrintComesNearTheDesign) {
  const ProgramRun run = Run({"--ArucoDetection.inverted", "1"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const MarkerShape shape = ReadShapeCsv((workspace() / "shape/shape.csv").string());
  EXPECT_EQ(NumWholeMarkers(shape), 10);
  const ShapeComparison comparison = CompareWithReference(kBoardVideo, shape);
  EXPECT_EQ(comparison.num_points, 40);
  EXPECT_LE(comparison.distance_m.rms, 0.0013);
  RecordProperty("rms_mm", Text(1e3 * comparison.distance_m.rms));
}

TEST_F(BoardVideoTest, WithoutTheOptionTheFailureNamesIt) {
  const ProgramRun run = Run({});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("error: "));
  EXPECT_THAT(run.err, HasSubstr("--ArucoDetection.inverted 1"));
  EXPECT_FALSE(fs::exists(workspace()));
}

}  // namespace
}  // namespace velamap
