// The single commands on databases and models of a synthetic scene, without pictures.

#include <SQLiteCpp/Database.h>
#include <fmt/format.h>

#include "exporters/formats/shape_csv.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model_io.h"
#include "tests/support/true_model.h"
#include "tests/workflows/commands/stages_fixture.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST_F(StagesTest, RegistratorWritesModelAndTable) {
  WriteDatabase(scene_, path("database.db"), 8, All);
  const ProgramRun run = Register();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("images_registered: 8 of 8\nimages_left_out: none\n"));
  EXPECT_EQ(ReadModel(path("sparse/seed")).images.size(), 8u);
  EXPECT_THAT(ListFolder(path("sparse")), ElementsAre("registration.csv", "seed"));
  EXPECT_EQ(NumErrorLines(run.err), 0) << run.err;
}

TEST_F(StagesTest, SameInputSameBytesWhateverTheThreads) {
  WriteDatabase(scene_, path("database.db"), 8, All);
  std::vector<std::string> first;
  for (const char* num_threads : {"1", "1", "2", "5"}) {
    const ProgramRun seed =
        RunVelamap({"frame_registrator", "--database_path", path("database.db"), "--marker_length",
                    "0.1", "--output_path", path("sparse/seed"), "--num_threads", num_threads});
    ASSERT_EQ(seed.exit_code, 0) << seed.err;
    const ProgramRun adjusted =
        RunVelamap({"bundle_adjuster", "--backend", "markers", "--input_path", path("sparse/seed"),
                    "--database_path", path("database.db"), "--marker_length", "0.1",
                    "--output_path", path("model"), "--num_threads", num_threads});
    ASSERT_EQ(adjusted.exit_code, 0) << adjusted.err;
    std::vector<std::string> bytes;
    for (const char* name : {"sparse/seed/points3D.bin", "sparse/seed/images.bin",
                             "model/points3D.bin", "model/images.bin", "model/uncertainty.bin"}) {
      bytes.push_back(ReadFileBytes(path(name)));
    }
    if (first.empty()) first = bytes;
    EXPECT_EQ(bytes, first) << num_threads << " threads";
  }
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
  EXPECT_THAT(run.out, HasSubstr("images_registered: 5 of 8\nimages_left_out: 3: shares 0"));
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
  WriteModel(TrueModel(scene_, kOtherUnit_m), path("model"), ModelFormat::kBinary);
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

TEST_F(StagesTest, MarkersOutsideTheLayoutAreCountedApart) {
  WriteModel(TrueModel(scene_, kOtherUnit_m), path("model"), ModelFormat::kBinary);
  const std::vector<int> ids = MarkerIds(scene_.layout);
  ASSERT_EQ(ids.size(), 12u);
  WriteTextFile(dir_ / "part.yml",
                fmt::format("dictionary: DICT_4X4_50\nmarker_length: 0.1\nparts:\n  board: "
                            "{{markers: [{}, {}, {}, {}]}}\n",
                            ids[0], ids[1], ids[2], ids[3]));
  const ProgramRun run =
      RunVelamap({"shape_exporter", "--input_path", path("model"), "--layout_path",
                  path("part.yml"), "--shape_path", path("shape")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("markers_reconstructed: 4 of 4 in the layout, and 8 others\n"));
  EXPECT_THAT(run.err, HasSubstr("8 markers of the shape are not in the layout"));
}

TEST_F(StagesTest, ExporterOnAFullDiskLeavesNothing) {
  WriteModel(TrueModel(scene_, kOtherUnit_m), path("model"), ModelFormat::kBinary);
  ExpectError(Export({1000}), 2, "shape.csv: cannot be written");
  EXPECT_THAT(ListFolder(dir_.path()), ElementsAre("model"));
}

TEST_F(StagesTest, ExporterRefusesAFolderWithOtherFiles) {
  WriteModel(TrueModel(scene_, kOtherUnit_m), path("model"), ModelFormat::kBinary);
  fs::create_directory(dir_ / "shape");
  WriteTextFile(dir_ / "shape/thesis.tex", "text");
  ExpectError(Export(), 2, "thesis.tex");
  EXPECT_THAT(ListFolder(dir_.path()), ElementsAre("model", "shape"));
}

TEST_F(StagesTest, TruncatedModelNamesItsFile) {
  WriteModel(TrueModel(scene_, kOtherUnit_m), path("model"), ModelFormat::kBinary);
  fs::resize_file(dir_ / "model/points3D.bin", 100);
  ExpectError(Export(), 2, "points3D.bin");
}

// All corners may be seen too far inside their markers, which shortens a side by two insets,
// whether or not a database says how the corners were found.
TEST_F(StagesTest, TheInsetOfAllCornersIsInTheSigmaOfTheScaleWithoutADatabaseToo) {
  WriteDatabase(scene_, path("database.db"), 8, All);
  ASSERT_EQ(Register().exit_code, 0);
  double largest_side_px = 0;
  for (const FrameDetections& frame : scene_.frames) {
    for (const MarkerDetection& marker : frame.markers) {
      const auto& x_px = marker.corners_in_image_px;
      largest_side_px =
          std::max({largest_side_px, (x_px[1] - x_px[0]).norm(), (x_px[2] - x_px[1]).norm()});
    }
  }
  std::vector<double> sigmas;
  for (const bool with_database : {true, false}) {
    std::vector<std::string> arguments = {"bundle_adjuster",
                                          "--backend",
                                          "markers",
                                          "--input_path",
                                          path("sparse/seed"),
                                          "--marker_length",
                                          "0.1",
                                          "--output_path",
                                          path("model"),
                                          "--MarkerAdjustment.common_print_tolerance",
                                          "1e-6"};
    if (with_database) {
      arguments.insert(arguments.end(), {"--database_path", path("database.db")});
    }
    const ProgramRun run = RunVelamap(arguments);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    sigmas.push_back(ReadUncertainty(path("model")).relative_scale_sigma);
  }
  EXPECT_GT(sigmas[1], 2 * 0.01 / largest_side_px);
  EXPECT_NEAR(sigmas[1], sigmas[0], 0.01 * sigmas[0]);
}

}  // namespace
}  // namespace velamap
