// COLMAP's own matchers, mappers and tools on velamap's databases and models.

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include <gmock/gmock.h>

#include "importer/database/correspondence.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/register_frames.h"
#include "reconstruct/seed_model.h"
#include "tests/workflows/interop/colmap_tools.h"
#include "tests/workflows/run_velamap.h"
#include "tests/workflows/stylus_workspace.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

SyntheticScene MakeScene(SceneKind kind) {
  SyntheticSceneOptions options;
  options.kind = kind;
  options.num_frames = kind == SceneKind::kCube ? 24 : 10;
  options.num_rows = kind == SceneKind::kCube ? 3 : 4;
  options.num_columns = options.num_rows;
  options.video = false;
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({0.1, 0.0, 0.0, 0.0, 1}, &scene);
  return scene;
}

std::vector<DatabaseImage> ReadImages(const std::string& database_path) {
  return ColmapDatabase(database_path, ColmapDatabase::Mode::kReadOnly).ReadImages();
}

// The corner that a track joins; nothing if it joins several.
std::optional<CornerId> CornerOfTrack(const Point3D& point,
                                      const std::vector<DatabaseImage>& images) {
  std::set<CornerId> corners;
  for (const TrackElement& element : point.track) {
    for (const DatabaseImage& image : images) {
      if (image.image_id != element.image_id) continue;
      corners.insert({image.detections.markers.at(element.point2D_idx / kNumCorners).marker_id,
                      static_cast<int>(element.point2D_idx % kNumCorners) + 1});
    }
  }
  if (corners.size() != 1) return std::nullopt;
  return *corners.begin();
}

// Fails for a track of several corners. Returns how many corners have a track.
int ExpectTracksOfOneCornerEach(const Model& model, const std::vector<DatabaseImage>& images) {
  std::set<CornerId> corners;
  for (const auto& [point3D_id, point] : model.points3D) {
    const std::optional<CornerId> corner = CornerOfTrack(point, images);
    EXPECT_TRUE(corner.has_value()) << "point " << point3D_id << " joins several corners";
    if (corner) corners.insert(*corner);
  }
  return static_cast<int>(corners.size());
}

// Corners that at least `min_num_images` images see.
int NumCorners(const std::vector<DatabaseImage>& images, int min_num_images) {
  std::map<int, int> num_images_of;
  for (const DatabaseImage& image : images) {
    for (const MarkerDetection& marker : image.detections.markers) {
      ++num_images_of[marker.marker_id];
    }
  }
  int num_corners = 0;
  for (const auto& [marker_id, num_images] : num_images_of) {
    if (num_images >= min_num_images) num_corners += kNumCorners;
  }
  return num_corners;
}

class ColmapTracksTest : public ColmapTest {
 protected:
  // The database without the matches that velamap wrote.
  void WriteUnmatched(const SyntheticScene& scene) {
    WriteSceneDatabase(scene, database());
    ExecuteSql(database(), "DELETE FROM matches");
    ExecuteSql(database(), "DELETE FROM two_view_geometries");
  }

  void Match() const {
    std::vector<std::string> arguments = {"exhaustive_matcher", "--database_path", database(),
                                          "--random_seed", "0"};
    AddOption({"SiftMatching.use_gpu", "FeatureMatching.use_gpu"}, "0", &arguments);
    AddOption({"SiftMatching.min_num_inliers", "TwoViewGeometry.min_num_inliers"}, "4", &arguments);
    RunCommand(arguments);
  }

  // The model that COLMAP's mapper makes of the database.
  Model Map() {
    fs::create_directory(dir_ / "mapped");
    fs::create_directory(dir_ / "images");
    std::vector<std::string> arguments = {"mapper",       "--database_path", database(),
                                          "--image_path", path("images"),    "--output_path",
                                          path("mapped")};
    AddMarkerOptions(&arguments);
    RunCommand(arguments);
    return ReadModel(path("mapped/0"));
  }

  // What lets `mapper` and `point_triangulator` live on a few markers a pair.
  static void AddMarkerOptions(std::vector<std::string>* arguments) {
    AddOption({"Mapper.min_num_matches"}, "4", arguments);
    AddOption({"Mapper.init_min_num_inliers"}, "16", arguments);
    AddOption({"Mapper.abs_pose_min_num_inliers"}, "8", arguments);
    AddOption({"Mapper.tri_ignore_two_view_tracks"}, "0", arguments);
    AddOption({"Mapper.ba_refine_focal_length"}, "0", arguments);
    AddOption({"Mapper.ba_refine_extra_params"}, "0", arguments);
    AddOption({"Mapper.extract_colors"}, "0", arguments);
    AddOption({"Mapper.num_threads"}, "1", arguments);
    AddOption({"Mapper.random_seed"}, "0", arguments);
    arguments->insert(arguments->end(), {"--random_seed", "0"});
  }

  std::string database() const { return path("database.db"); }
};

class ColmapMatchesTest : public ColmapTracksTest,
                          public ::testing::WithParamInterface<SceneKind> {};

TEST_P(ColmapMatchesTest, ExhaustiveMatcherFindsWhatTheMarkerIdsSay) {
  const SyntheticScene scene = MakeScene(GetParam());
  WriteUnmatched(scene);
  Match();
  const auto images = ReadImages(database());
  int num_matches = 0, num_verified = 0, num_pairs_without = 0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    for (std::size_t j = i + 1; j < images.size(); ++j) {
      const DatabaseImage &first = images[i], &second = images[j];
      const FeatureMatches expected = MatchByMarkerId(first.detections, second.detections);
      const MatchSet expected_set(expected.begin(), expected.end());
      EXPECT_EQ(QueryMatches(database(), "matches", first.image_id, second.image_id), expected_set)
          << first.detections.image_name << " and " << second.detections.image_name;
      const MatchSet verified =
          QueryMatches(database(), "two_view_geometries", first.image_id, second.image_id);
      EXPECT_TRUE(std::includes(expected_set.begin(), expected_set.end(), verified.begin(),
                                verified.end()));
      num_matches += static_cast<int>(expected.size());
      num_verified += static_cast<int>(verified.size());
      num_pairs_without += expected.empty();
    }
  }
  EXPECT_GT(num_matches, 1000);
  EXPECT_GT(num_verified, 0.9 * num_matches);
  // On a cube some pairs share nothing, and COLMAP must not think otherwise.
  EXPECT_EQ(num_pairs_without > 0, GetParam() == SceneKind::kCube);
  RecordProperty("num_matches", num_matches);
  RecordProperty("num_verified", num_verified);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ColmapMatchesTest,
                         ::testing::Values(SceneKind::kSail, SceneKind::kCube),
                         [](const ::testing::TestParamInfo<SceneKind>& test) {
                           return test.param == SceneKind::kCube ? "Cube" : "Sail";
                         });

TEST_F(ColmapTracksTest, MapperFindsTheTracksOfTheMarkers) {
  WriteUnmatched(MakeScene(SceneKind::kCube));
  Match();
  const Model model = Map();
  const auto images = ReadImages(database());
  const int num_corners = ExpectTracksOfOneCornerEach(model, images);
  EXPECT_EQ(model.images.size(), images.size());
  EXPECT_GE(num_corners, 0.95 * NumCorners(images, 2));
  RecordProperty("num_corners", num_corners);
  RecordProperty("num_corners_seen_twice", NumCorners(images, 2));
  RecordProperty("num_points", static_cast<int>(model.points3D.size()));
}

// Beyond kMaxNumExhaustive images the database holds the matches of a few pairs of each image only.
TEST_F(ColmapTracksTest, MapperFindsAllTracksInThePairsOfALongClip) {
  SyntheticSceneOptions options;
  options.num_frames = kMaxNumExhaustive + 10;
  options.num_rows = 4;
  options.num_columns = 4;
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({0.1, 0.0, 0.0, 0.0, 1}, &scene);
  WriteSceneDatabase(scene, database());
  const Model model = Map();
  const auto images = ReadImages(database());
  EXPECT_EQ(model.images.size(), images.size());
  EXPECT_EQ(ExpectTracksOfOneCornerEach(model, images), NumCorners(images, 2));
}

TEST_F(ColmapTracksTest, PointTriangulatorKeepsTheSeed) {
  const SyntheticScene scene = MakeScene(SceneKind::kCube);
  WriteSceneDatabase(scene, database());
  const auto images = ReadImages(database());
  const Registration registration = RegisterFrames(images, {{1, scene.camera}}, scene.layout, {});
  const Model seed = MakeSeedModel(registration, images, {{1, scene.camera}});
  WriteModel(seed, path("seed"), ModelFormat::kBinary);
  fs::create_directory(dir_ / "triangulated");
  fs::create_directory(dir_ / "images");
  std::vector<std::string> arguments = {
      "point_triangulator", "--database_path", database(),      "--image_path",      path("images"),
      "--input_path",       path("seed"),      "--output_path", path("triangulated")};
  AddOption({"clear_points"}, "0", &arguments);
  AddMarkerOptions(&arguments);
  RunCommand(arguments);
  const Model model = ReadModel(path("triangulated"));
  EXPECT_EQ(model.images.size(), seed.images.size());
  const int num_corners = ExpectTracksOfOneCornerEach(model, images);
  EXPECT_GE(num_corners, static_cast<int>(seed.points3D.size()));
  int num_kept = 0;
  for (const auto& [point3D_id, point] : model.points3D) {
    num_kept += IsCornerPoint3DId(point3D_id) &&
                CornerOfTrack(point, images) == CornerFromPoint3DId(point3D_id);
  }
  RecordProperty("num_points_of_seed", static_cast<int>(seed.points3D.size()));
  RecordProperty("num_points", static_cast<int>(model.points3D.size()));
  RecordProperty("num_point_ids_kept", num_kept);
}

// Everything that COLMAP offers on a finished workspace.
class ColmapResultTest : public ColmapTracksTest {
 protected:
  void SetUp() override {
    ColmapTracksTest::SetUp();
    if (IsSkipped()) return;
    CopyStylusWorkspace(path("workspace"));
    model_ = ReadModel(result());
  }

  std::string result() const { return path("workspace/sparse/0"); }

  void Convert(const std::string& type, const std::string& output_name,
               const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {
        "model_converter", "--input_path",  result(), "--output_path",
        path(output_name), "--output_type", type};
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunCommand(arguments);
  }

  Model model_;
};

TEST_F(ColmapResultTest, IsAnalyzedAndConverted) {
  const std::string analysis = RunCommand({"model_analyzer", "--path", result()});
  EXPECT_THAT(analysis, HasSubstr("Images: " + std::to_string(model_.images.size())));
  EXPECT_THAT(analysis, HasSubstr("Points: " + std::to_string(model_.points3D.size())));

  fs::create_directory(dir_ / "text");
  Convert("TXT", "text");
  const Model text = ReadModel(path("text"));
  EXPECT_EQ(text.images.size(), model_.images.size());
  ASSERT_EQ(text.points3D.size(), model_.points3D.size());
  for (const auto& [point3D_id, point] : model_.points3D) {
    EXPECT_LT((text.points3D.at(point3D_id).x_in_world - point.x_in_world).norm(), 1e-12);
  }

  Convert("PLY", "points.ply");
  EXPECT_THAT(ReadFileBytes(dir_ / "points.ply"),
              HasSubstr("element vertex " + std::to_string(model_.points3D.size())));

  Convert("VRML", "scene");
  EXPECT_TRUE(fs::exists(dir_ / "scene.points3D.wrl"));

  // The others hold no OpenCV distortion.
  fs::create_directory(dir_ / "cam");
  Convert("CAM", "cam", {"--skip_distortion", "1"});
  EXPECT_EQ(ListFolder(dir_ / "cam").size(), model_.images.size());
  Convert("R3D", "recon3d", {"--skip_distortion", "1"});
  EXPECT_FALSE(ListFolder(dir_ / "recon3d").empty());
  Convert("NVM", "model.nvm", {"--skip_distortion", "1"});
  std::ifstream nvm(path("model.nvm"));
  std::string version;
  std::size_t num_images = 0;
  nvm >> version >> num_images;
  EXPECT_THAT(version, HasSubstr("NVM_V3"));
  EXPECT_EQ(num_images, model_.images.size());

  Convert("Bundler", "bundler", {"--skip_distortion", "1"});
  std::ifstream bundle(path("bundler.bundle.out"));
  std::size_t num_points = 0;
  std::getline(bundle, version);
  bundle >> num_images >> num_points;
  EXPECT_THAT(version, HasSubstr("Bundle file"));
  EXPECT_EQ(num_images, model_.images.size());
  EXPECT_EQ(num_points, model_.points3D.size());
}

TEST_F(ColmapResultTest, IsUndistortedWithItsImages) {
  RunCommand({"image_undistorter", "--image_path", path("workspace/images"), "--input_path",
              result(), "--output_path", path("dense"), "--output_type", "COLMAP",
              "--max_image_size", "640"});
  EXPECT_EQ(ListFolder(dir_ / "dense/images"), ListFolder(dir_ / "workspace/images"));
  EXPECT_EQ(ReadModel(path("dense/sparse")).points3D.size(), model_.points3D.size());
  // What patch_match_stereo starts from: every image is a reference.
  const std::string stereo = ReadFileBytes(dir_ / "dense/stereo/patch-match.cfg");
  for (const ModelImage& image : model_.images) EXPECT_THAT(stereo, HasSubstr(image.name));
}

TEST_F(ColmapResultTest, IsTriangulatedWithItsDatabase) {
  fs::create_directory(dir_ / "triangulated");
  std::vector<std::string> arguments = {"point_triangulator",
                                        "--database_path",
                                        path("workspace/database.db"),
                                        "--image_path",
                                        path("workspace/images"),
                                        "--input_path",
                                        result(),
                                        "--output_path",
                                        path("triangulated")};
  AddOption({"clear_points"}, "0", &arguments);
  AddMarkerOptions(&arguments);
  RunCommand(arguments);
  const Model model = ReadModel(path("triangulated"));
  EXPECT_EQ(model.images.size(), model_.images.size());
  const int num_corners =
      ExpectTracksOfOneCornerEach(model, ReadImages(path("workspace/database.db")));
  EXPECT_GE(num_corners, static_cast<int>(model_.points3D.size()));
}

}  // namespace
}  // namespace velamap
