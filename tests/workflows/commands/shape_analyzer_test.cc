// shape_analyzer: the same figures on stdout and in files, and input that does not fit together.

#include "reconstruct/model/model_io.h"
#include "tests/support/true_model.h"
#include "tests/workflows/commands/stages_fixture.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;

class ShapeAnalyzerCommandTest : public StagesTest {};

TEST_F(ShapeAnalyzerCommandTest, SaysTheSameOnStdoutAndInItsFiles) {
  WriteModel(TrueModel(scene_, kOtherUnit_m), path("model"), ModelFormat::kBinary);
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
  EXPECT_THAT(run.err, HasSubstr("9 markers of the shape are not in the layout"));
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

TEST_F(ShapeAnalyzerCommandTest, NoticesTheModelOfAnotherShape) {
  Model model = TrueModel(scene_, kOtherUnit_m);
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

TEST_F(ShapeAnalyzerCommandTest, OutputThatCannotBeWritten) {
  WriteModel(TrueModel(scene_, kOtherUnit_m), path("model"), ModelFormat::kBinary);
  ASSERT_EQ(Export().exit_code, 0);
  for (const char* option : {"--csv_path", "--json_path"}) {
    ExpectError(RunVelamap({"shape_analyzer", "--shape_path", path("shape"), "--part_planes", "1",
                            option, path("shape/shape.csv/a")}),
                2, "shape/shape.csv: cannot be written: Not a directory");
  }
  ExpectError(RunVelamap({"shape_analyzer", "--shape_path", path("shape"), "--part_planes", "1",
                          "--csv_path", path("a"), "--json_path", path("a")}),
              2, "--json_path");
  EXPECT_FALSE(fs::exists(dir_ / "a"));
}

TEST_F(ShapeAnalyzerCommandTest, WantsSomethingToCompareWith) {
  ExpectError(RunVelamap({"shape_analyzer", "--shape_path", path("shape.csv")}), 2,
              "--reference_path");
}

}  // namespace
}  // namespace velamap
