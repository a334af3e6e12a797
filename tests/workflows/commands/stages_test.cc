// The single commands on databases and models of a synthetic scene, without pictures.

#include <algorithm>

#include <SQLiteCpp/Database.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/formats/shape_csv.h"
#include "importer/database/colmap_database.h"
#include "reconstruct/model/model_io.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/commands/true_model.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

SyntheticScene MakeScene() {
  SyntheticSceneOptions options;
  options.num_rows = 3;
  options.num_columns = 4;
  options.num_frames = 8;
  options.video = false;
  return MakeSyntheticScene(options);
}

// Keeps every frame whose index `keep` accepts, and of its markers those that `keep_id` accepts.
template <typename KeepId>
void WriteDatabase(const SyntheticScene& scene, const fs::path& path, int num_frames,
                   KeepId keep_id) {
  ColmapDatabase database(path.string(), ColmapDatabase::Mode::kReadWriteCreate);
  const CameraId camera_id = database.AddCamera(scene.camera);
  for (int i = 0; i < num_frames; ++i) {
    FrameDetections detections = scene.frames[static_cast<std::size_t>(i)];
    auto& markers = detections.markers;
    markers.erase(std::remove_if(markers.begin(), markers.end(),
                                 [&](const auto& m) { return !keep_id(i, m.marker_id); }),
                  markers.end());
    database.AddImage(camera_id, detections, "test");
  }
}

bool All(int, int) { return true; }

class StagesTest : public ::testing::Test {
 protected:
  ProgramRun Register(const ProgramLimits& limits = {}) {
    return RunVelamap({"frame_registrator", "--database_path", path("database.db"),
                       "--marker_length", "0.1", "--output_path", path("sparse/seed")},
                      limits);
  }

  ProgramRun Export(const ProgramLimits& limits = {}) {
    return RunVelamap({"shape_exporter", "--input_path", path("model"), "--marker_length", "0.1",
                       "--shape_path", path("shape"), "--output_path", path("metric")},
                      limits);
  }

  void ExpectError(const ProgramRun& run, int exit_code, const std::string& expected) {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_THAT(run.err, HasSubstr("error: "));
    EXPECT_THAT(run.err, HasSubstr(expected));
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
    EXPECT_EQ(run.out, "");
  }

  std::string path(const std::string& name) const { return (dir_ / name).string(); }

  const SyntheticScene scene_ = MakeScene();
  TempDir dir_;
};

TEST_F(StagesTest, RegistratorWritesModelAndTable) {
  WriteDatabase(scene_, path("database.db"), 8, All);
  const ProgramRun run = Register();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("images_registered: 8 of 8\nimages_left_out: none\n"));
  EXPECT_EQ(ReadModel(path("sparse/seed")).images.size(), 8u);
  EXPECT_THAT(ListFolder(path("sparse")), ElementsAre("registration.csv", "seed"));
  EXPECT_EQ(NumErrorLines(run.err), 0) << run.err;
}

TEST_F(StagesTest, SameInputSameBytes) {
  WriteDatabase(scene_, path("database.db"), 8, All);
  ASSERT_EQ(Register().exit_code, 0);
  const std::string first = ReadFileBytes(path("sparse/seed/points3D.bin"));
  ASSERT_EQ(Register().exit_code, 0);
  EXPECT_EQ(ReadFileBytes(path("sparse/seed/points3D.bin")), first);
}

TEST_F(StagesTest, CentralFrameAloneGivesTheShapeOfItsSingleMarkers) {
  SyntheticSceneOptions options;
  options.num_rows = 3;
  options.num_columns = 4;
  options.num_frames = 8;
  WriteDatabase(MakeSyntheticScene(options), path("database.db"), 8, All);
  const ProgramRun run =
      RunVelamap({"frame_registrator", "--database_path", path("database.db"), "--marker_length",
                  "0.1", "--output_path", path("model"), "--Registration.method", "thesis",
                  "--Registration.num_frames", "0", "--central_frame", "3"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Model model = ReadModel(path("model"));
  ASSERT_EQ(model.images.size(), 1u);
  EXPECT_EQ(model.images[0].name, "frame_000003.jpg");
  EXPECT_EQ(Export().exit_code, 0);
}

TEST_F(StagesTest, MarkerAwareAdjustmentIsMetricAndKnowsItsSigmas) {
  WriteDatabase(scene_, path("database.db"), 8, All);
  ASSERT_EQ(Register().exit_code, 0);
  const ProgramRun run = RunVelamap({"bundle_adjuster", "--backend", "markers", "--input_path",
                                     path("sparse/seed"), "--database_path", path("database.db"),
                                     "--marker_length", "0.1", "--output_path", path("model")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("scale_sigma: "));
  EXPECT_TRUE(fs::exists(dir_ / "model/uncertainty.bin"));
  ASSERT_EQ(Export().exit_code, 0);
  const MarkerShape shape = ReadShapeCsv(path("shape/shape.csv"));
  ASSERT_EQ(shape.markers.size(), 12u);
  for (const ShapeMarker& marker : shape.markers) {
    ASSERT_TRUE(marker.sigma_m[0]) << marker.marker_id;
    EXPECT_GT(marker.sigma_m[0]->minCoeff(), 0.0);
    EXPECT_LT(marker.sigma_m[0]->maxCoeff(), 0.01);
    EXPECT_NEAR(MarkerSides(marker)[0], 0.1, 1e-6);
  }
}

TEST_F(StagesTest, OneImageIsNoShape) {
  WriteDatabase(scene_, path("database.db"), 1, All);
  ExpectError(Register(), 1, "at least two images");
  EXPECT_FALSE(fs::exists(dir_ / "sparse"));
}

TEST_F(StagesTest, ImagesThatShareNoMarker) {
  WriteDatabase(scene_, path("database.db"), 2,
                [](int frame_idx, int id) { return id % 2 == frame_idx; });
  ExpectError(Register(), 1, "no two images agree on the places of at least 2 markers");
  EXPECT_FALSE(fs::exists(dir_ / "sparse"));
}

TEST_F(StagesTest, OfTwoGroupsTheLargerIsUsedAndTheOtherNamed) {
  WriteDatabase(scene_, path("database.db"), 8,
                [](int frame_idx, int id) { return id % 2 == (frame_idx < 5 ? 0 : 1); });
  const ProgramRun run = Register();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("images_registered: 5 of 8\nimages_left_out: 3; 3: shares 0"));
}

TEST_F(StagesTest, DatabaseThatIsMissingOrNone) {
  ExpectError(Register(), 2, "database.db");
  EXPECT_FALSE(fs::exists(dir_ / "database.db"));
  WriteTextFile(dir_ / "database.db", "no database at all, but long enough to hold a header");
  ExpectError(Register(), 2, "database.db");
  fs::remove(dir_ / "database.db");
  SQLite::Database(path("database.db"), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE)
      .exec("CREATE TABLE recipes (name TEXT)");
  ExpectError(Register(), 2, "database.db");
}

TEST_F(StagesTest, DatabaseThatIsLocked) {
  WriteDatabase(scene_, path("database.db"), 8, All);
  SQLite::Database lock(path("database.db"), SQLite::OPEN_READWRITE);
  lock.exec("BEGIN EXCLUSIVE");
  ExpectError(Register(), 2, "locked");
  lock.exec("ROLLBACK");
  EXPECT_EQ(Register().exit_code, 0);
}

TEST_F(StagesTest, RegistratorRefusesAFolderWithOtherFiles) {
  WriteDatabase(scene_, path("database.db"), 8, All);
  fs::create_directories(dir_ / "sparse/seed");
  WriteTextFile(dir_ / "sparse/seed/thesis.tex", "text");
  ExpectError(Register(), 2, "thesis.tex");
  EXPECT_THAT(ListFolder(path("sparse/seed")), ElementsAre("thesis.tex"));
}

TEST_F(StagesTest, FullDiskLeavesTheOldModel) {
  WriteDatabase(scene_, path("database.db"), 8, All);
  ASSERT_EQ(Register().exit_code, 0);
  const std::string before = ReadFileBytes(path("sparse/seed/images.txt"));
  ExpectError(Register({1000}), 2, "seed");
  EXPECT_EQ(ReadFileBytes(path("sparse/seed/images.txt")), before);
  EXPECT_THAT(ListFolder(path("sparse")), ElementsAre("registration.csv", "seed"));
}

TEST_F(StagesTest, ExporterGivesTheTruthBack) {
  WriteModel(TrueModel(scene_), path("model"), ModelFormat::kBinary);
  const ProgramRun run = Export();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("scale_m_per_unit: 2\n"));
  EXPECT_THAT(run.out, HasSubstr("area_error_mm2: mean 0.000,"));
  const MarkerShape shape = ReadShapeCsv(path("shape/shape.csv"));
  ASSERT_EQ(shape.markers.size(), scene_.x_in_world.size());
  for (const ShapeMarker& marker : shape.markers) {
    for (std::size_t i = 0; i <= kNumCorners; ++i) {
      EXPECT_LT((*marker.x_in_shape_m[i] - scene_.x_in_world.at(marker.marker_id)[i]).norm(), 1e-9);
    }
  }
  const ProgramRun analysis =
      RunVelamap({"shape_analyzer", "--shape_path", path("shape"), "--marker_length", "0.1",
                  "--reference_path", path("shape/shape.csv")});
  EXPECT_EQ(analysis.exit_code, 0) << analysis.err;
  EXPECT_THAT(analysis.out, HasSubstr("num_markers: 12\n"));
  EXPECT_THAT(analysis.out, HasSubstr("num_points: 48\n"));
}

TEST_F(StagesTest, AnalyzerSaysTheSameOnStdoutAndInItsFiles) {
  WriteModel(TrueModel(scene_), path("model"), ModelFormat::kBinary);
  ASSERT_EQ(Export().exit_code, 0);
  WriteTextFile(dir_ / "layout.yml",
                "dictionary: DICT_4X4_50\nmarker_length: 0.1\nparts:\n"
                "  sail: {markers: [0, 1, 2, 40], rigid: true}\n");
  const std::vector<std::string> arguments = {"shape_analyzer",
                                              "--shape_path",
                                              path("shape"),
                                              "--layout_path",
                                              path("layout.yml"),
                                              "--input_path",
                                              path("metric"),
                                              "--reference_path",
                                              path("shape"),
                                              "--part_planes",
                                              "1",
                                              "--csv_path",
                                              path("a.csv"),
                                              "--json_path",
                                              path("a.json")};
  const ProgramRun run = RunVelamap(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const std::string first_image = ReadModel(path("model")).images.front().name;
  const std::string json = ReadFileBytes(dir_ / "a.json"), csv = ReadFileBytes(dir_ / "a.csv");
  const std::vector<std::pair<std::string, std::string>> figures = {
      {"central_image_name", first_image},
      {"num_markers", "12"},
      {"reprojection_error_px_count", "384"},
      {"central_reprojection_error_px_count", "48"},
      {"num_layout_markers", "4"},
      {"reconstruction_ratio", "0.75"},
      {"image_marker_ratio_count", "8"},
      {"missing_marker_ids", "40"},
      {"adjacent_distance_error_mm_max", "0"},
      {"num_points", "48"}};
  for (const auto& [key, value] : figures) {
    EXPECT_THAT(run.out, HasSubstr(key + ": " + value + "\n"));
    EXPECT_THAT(csv, HasSubstr(",," + key + "," + value + "\n"));
    EXPECT_THAT(json, HasSubstr("\"" + key + "\": "));
  }
  for (const char* table : {"images", "parts"}) {
    EXPECT_THAT(run.out, HasSubstr(std::string("\n") + table + ": "));
    EXPECT_THAT(csv, HasSubstr(std::string("\n") + table + ",0,"));
    EXPECT_THAT(json, HasSubstr(std::string("\"") + table + "\": ["));
  }
  EXPECT_EQ(RunVelamap(arguments).exit_code, 0);  // files of an earlier run are replaced
  EXPECT_EQ(ReadFileBytes(dir_ / "a.json"), json);
}

TEST_F(StagesTest, AnalyzerNoticesTheModelOfAnotherShape) {
  Model model = TrueModel(scene_);
  WriteModel(model, path("model"), ModelFormat::kBinary);
  ASSERT_EQ(Export().exit_code, 0);
  const std::vector<std::string> arguments = {"shape_analyzer", "--shape_path", path("shape"),
                                              "--input_path", path("model")};
  EXPECT_EQ(RunVelamap(arguments).err, "");  // the scale is no difference
  model.points3D.begin()->second.x_in_world.z() += 0.01;
  WriteModel(model, path("model"), ModelFormat::kBinary);
  EXPECT_THAT(RunVelamap(arguments).err, HasSubstr("is not the shape of the model"));
  for (auto it = model.points3D.begin(); it != model.points3D.end();) {
    const auto [id, element] = std::pair(it->first, it->second.track);
    ++it;
    for (const TrackElement& seen : element) RemoveObservation(&model, id, seen);
  }
  RemoveShortTracks(&model, 1);
  WriteModel(model, path("model"), ModelFormat::kBinary);
  ExpectError(RunVelamap(arguments), 2, "shares fewer than three corners");
}

TEST_F(StagesTest, AnalyzerOutputThatCannotBeWritten) {
  WriteModel(TrueModel(scene_), path("model"), ModelFormat::kBinary);
  ASSERT_EQ(Export().exit_code, 0);
  for (const char* option : {"--csv_path", "--json_path"}) {
    ExpectError(RunVelamap({"shape_analyzer", "--shape_path", path("shape"), "--part_planes", "1",
                            option, path("shape/shape.csv/a")}),
                2, "shape.csv/a");
  }
  ExpectError(RunVelamap({"shape_analyzer", "--shape_path", path("shape"), "--part_planes", "1",
                          "--csv_path", path("a"), "--json_path", path("a")}),
              2, "--json_path");
  EXPECT_FALSE(fs::exists(dir_ / "a"));
}

TEST_F(StagesTest, ExporterOnAFullDiskLeavesNothing) {
  WriteModel(TrueModel(scene_), path("model"), ModelFormat::kBinary);
  ExpectError(Export({1000}), 2, "shape.csv: cannot be written");
  EXPECT_THAT(ListFolder(dir_.path()), ElementsAre("model"));
}

TEST_F(StagesTest, ExporterRefusesAFolderWithOtherFiles) {
  WriteModel(TrueModel(scene_), path("model"), ModelFormat::kBinary);
  fs::create_directory(dir_ / "shape");
  WriteTextFile(dir_ / "shape/thesis.tex", "text");
  ExpectError(Export(), 2, "thesis.tex");
  EXPECT_THAT(ListFolder(dir_.path()), ElementsAre("model", "shape"));
}

TEST_F(StagesTest, TruncatedModelNamesItsFile) {
  WriteModel(TrueModel(scene_), path("model"), ModelFormat::kBinary);
  fs::resize_file(dir_ / "model/points3D.bin", 100);
  ExpectError(Export(), 2, "points3D.bin");
}

TEST_F(StagesTest, AnalyzerWantsSomethingToCompareWith) {
  ExpectError(RunVelamap({"shape_analyzer", "--shape_path", path("shape.csv")}), 2,
              "--reference_path");
}

}  // namespace
}  // namespace velamap
