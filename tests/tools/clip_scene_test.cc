#include "tests/support/clip/clip_scene.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "exporters/formats/shape_csv.h"
#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "importer/camera/calibration.h"
#include "importer/geometry/units.h"
#include "tests/support/clip/clip_files.h"
#include "tests/support/render/nine_bit_dictionary.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

ClipScene MakeScene(ClipKind kind) {
  ClipOptions options;
  options.kind = kind;
  options.num_frames = 4;
  if (kind == ClipKind::kBoard) options.distance_m = 0.6;
  return MakeClipScene(options);
}

// Made once: its markers are laid out cell by cell.
const ClipScene& Sail() {
  static const ClipScene scene = MakeScene(ClipKind::kSail);
  return scene;
}

TEST(ClipSceneTest, SailHasTheMarkersOfTheThesis) {
  const Layout& layout = Sail().layout;
  ASSERT_EQ(layout.parts.size(), 2U);
  const LayoutPart& sail = layout.parts[0];
  EXPECT_EQ(sail.horizontal.size(), 7U);
  ASSERT_EQ(sail.vertical.size(), 1U);
  std::set<int> ids(sail.vertical[0].marker_ids.begin(), sail.vertical[0].marker_ids.end());
  for (const MarkerLine& line : sail.horizontal) {
    const auto crossings = std::count_if(line.marker_ids.begin(), line.marker_ids.end(),
                                         [&](int id) { return ids.count(id) > 0; });
    EXPECT_EQ(crossings, 1);
    ids.insert(line.marker_ids.begin(), line.marker_ids.end());
  }
  EXPECT_EQ(ids.size(), 114U);
  EXPECT_EQ(layout.parts[1].marker_ids.size(), 8U);
  EXPECT_EQ(MarkerIds(layout).size(), 122U);
}

TEST(ClipSceneTest, FlatMarkersAreExactSquares) {
  for (const ClipKind kind : {ClipKind::kBoard, ClipKind::kWalls}) {
    const ClipScene scene = MakeScene(kind);
    const double length_m = scene.layout.marker_length_m;
    for (const ShapeMarker& marker : TrueShape(scene, false).markers) {
      for (const double side : MarkerSides(marker)) EXPECT_NEAR(side, length_m, 1e-9);
      EXPECT_NEAR(MarkerArea(marker), length_m * length_m, 1e-9);
    }
  }
}

TEST(ClipSceneTest, MarkersOnTheSailFollowTheCloth) {
  std::vector<double> sides;
  for (const ShapeMarker& marker : TrueShape(Sail(), false).markers) {
    for (const double side : MarkerSides(marker)) sides.push_back(side);
  }
  const Statistics statistics = ComputeStatistics(sides);
  EXPECT_LT(statistics.mean, 0.1);
  EXPECT_GT(statistics.min, 0.0993);
  EXPECT_LT(statistics.max, 0.1002);
}

TEST(ClipSceneTest, MarkersDoNotTouch) {
  ClipOptions small;
  small.sail_scale = 0.5;
  for (const ClipScene& scene : {Sail(), MakeClipScene(small)}) {
    const MarkerShape shape = TrueShape(scene, false);
    for (const ShapeMarker& a : shape.markers) {
      for (const ShapeMarker& b : shape.markers) {
        if (a.marker_id < b.marker_id) {
          EXPECT_GT((*a.x_in_shape_m[0] - *b.x_in_shape_m[0]).norm(), 0.13);
        }
      }
    }
  }
}

// The camera sways by 4 degrees more at most.
TEST(ClipSceneTest, CameraGoesAroundAsFarAsIsAsked) {
  for (const double drift_deg : {20.0, 60.0}) {
    ClipOptions options;
    options.num_frames = 2;
    options.drift_deg = drift_deg;
    const ClipScene scene = MakeClipScene(options);
    const Rigid3 last_from_first = scene.cam_from_world(1) * Inverse(scene.cam_from_world(0));
    const double angle_deg = kDegPerRad * AngularDistance(last_from_first, Rigid3{});
    EXPECT_NEAR(angle_deg, 2 * drift_deg, 4);
  }
}

TEST(ClipSceneTest, FlappingHasTheTruthAsItsMean) {
  ClipScene scene = Sail();
  ClipOptions& options = scene.options;
  options.num_frames = 50;
  options.sail_motion_m = 0.05;
  const ClipVertex& leech = scene.markers[19].corners[1];
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  double largest_m = 0;
  for (int i = 0; i < options.num_frames; ++i) {
    const Eigen::Vector3d x_m = PositionInFrame(scene, leech, i);
    sum_m += x_m;
    largest_m = std::max(largest_m, (x_m - leech.x_before_m).norm());
  }
  EXPECT_LT((sum_m / options.num_frames - leech.x_before_m).norm(), 1e-12);
  EXPECT_GT(largest_m, 0.015);
  EXPECT_LE(largest_m, 0.05);
}

TEST(ClipSceneTest, TrimChangesHalfwayByTheStatedWay) {
  ClipOptions options;
  options.num_frames = 40;
  options.trim_change_m = 0.2;
  options.sail_scale = 0.5;
  const ClipScene scene = MakeClipScene(options);
  double largest_m = 0;
  for (const ClipVertex& vertex : scene.sheets.back().vertices) {
    EXPECT_EQ(PositionInFrame(scene, vertex, 0), vertex.x_before_m);
    EXPECT_EQ(PositionInFrame(scene, vertex, 39), vertex.x_after_m);
    largest_m = std::max(largest_m, (vertex.x_after_m - vertex.x_before_m).norm());
  }
  EXPECT_NEAR(largest_m, 0.2, 0.02);
}

TEST(ClipSceneTest, AnyLensReadsBack) {
  const TempDir dir;
  ClipOptions options;
  options.width_px = 960;
  for (const Camera& lens :
       {Camera{CameraModel::kOpenCVFisheye, 1920, 1080, {950, 950, 965, 537, 0.02, -0.01, 0, 0}},
        Camera{CameraModel::kRadial, 1920, 1080, {1500, 965, 537, -0.1, 0.02}}}) {
    options.camera = lens;
    const ClipScene scene = MakeClipScene(options);
    EXPECT_EQ(scene.camera, ScaleToImageSize(lens, 960, 540, "lens"));
    WriteClipFiles(scene, dir.path());
    const Camera read = ReadCalibration((dir / "camera.yml").string());
    const Eigen::Vector3d x(0.4, -0.2, 1.0);
    EXPECT_LT((*ImageFromCam(read, x) - *ImageFromCam(scene.camera, x)).norm(), 1e-9);
  }
}

TEST(ClipSceneTest, FilesReadBack) {
  TempDir dir;
  ClipOptions options;
  options.dictionary_bits = 3;
  options.width_px = 1280;
  const ClipScene scene = MakeClipScene(options);
  WriteClipFiles(scene, dir.path());
  const Camera camera = ReadCalibration((dir / "camera.yml").string());
  EXPECT_EQ(camera.width_px, 1280);
  ASSERT_EQ(camera.params.size(), scene.camera.params.size());
  for (std::size_t i = 0; i < camera.params.size(); ++i) {
    EXPECT_NEAR(camera.params[i], scene.camera.params[i], 1e-12 * 2000);
  }
  const Layout layout = ReadLayout((dir / "layout.yml").string());
  EXPECT_EQ(MarkerIds(layout), MarkerIds(scene.layout));
  EXPECT_EQ(BuildAdjacencyGraph(layout), BuildAdjacencyGraph(scene.layout));
  const Dictionary dictionary = LoadDictionary(layout.dictionary);
  EXPECT_EQ(cv::norm(dictionary.aruco->bytesList, scene.dictionary.aruco->bytesList), 0);
  const MarkerShape truth = ReadShapeCsv((dir / "truth.csv").string());
  EXPECT_EQ(truth.markers.size(), scene.markers.size());
  EXPECT_EQ(truth.markers[7].x_in_shape_m[3], scene.markers[7].corners[2].x_before_m);
}

TEST(ClipSceneTest, MarkersHaveTheSizeBitsAndBorderThatWereAskedFor) {
  ClipOptions options;
  options.dictionary_bits = 5;
  options.border_bits = 2;
  options.marker_length_m = 0.06;
  const ClipScene scene = MakeClipScene(options);
  EXPECT_EQ(scene.layout.dictionary, "DICT_5X5_250");
  EXPECT_EQ(scene.layout.border_bits, 2);
  for (const ClipMarker& marker : scene.markers) {
    EXPECT_EQ(marker.cells.rows, 9);
    const double side_m = (marker.corners[1].x_before_m - marker.corners[0].x_before_m).norm();
    EXPECT_NEAR(side_m, 0.06, 6e-5) << marker.marker_id;  // the cloth is bent, this is a chord
  }
}

TEST(ClipSceneTest, OptionsOutOfRangeAreNamed) {
  ClipOptions options;
  options.width_px = 1000;
  EXPECT_THROW(MakeClipScene(options), InputError);
  options = {};
  options.motion = 'i';
  EXPECT_THROW(MakeClipScene(options), InputError);
}

TEST(NineBitDictionaryTest, OnlyTheLastTwoLookTheSameWhenTurned) {
  const Dictionary dictionary = MakeNineBitDictionary();
  const cv::Mat& bytes = dictionary.aruco->bytesList;
  ASSERT_EQ(bytes.rows, 122);
  std::set<int> all_codes;
  for (int id = 0; id < bytes.rows; ++id) {
    cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(bytes.row(id), 3);
    std::set<int> codes;
    for (int turn = 0; turn < 4; ++turn) {
      int code = 0;
      for (const auto bit : cv::Mat_<std::uint8_t>(bits)) code = 2 * code + bit;
      codes.insert(code);
      cv::rotate(bits, bits, cv::ROTATE_90_CLOCKWISE);
    }
    EXPECT_EQ(codes.size(), id < 120 ? 4U : 2U) << id;
    const std::size_t before = all_codes.size();
    all_codes.insert(codes.begin(), codes.end());
    EXPECT_EQ(all_codes.size(), before + codes.size()) << id;
  }
}

}  // namespace
}  // namespace velamap
