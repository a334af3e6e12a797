// Every option that takes a path, with a name that is longer than the file system allows.

#include <map>
#include <regex>
#include <sstream>

#include <opencv2/aruco.hpp>
#include <opencv2/videoio.hpp>

#include "reconstruct/model/model_io.h"
#include "tests/importer/marker_builders.h"
#include "tests/support/true_model.h"
#include "tests/workflows/commands/stages_fixture.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
using Options = std::map<std::string, std::string>;

// A cameras.txt of COLMAP for the clip.
constexpr char kCamera[] = "1 PINHOLE 320 200 300 300 160 100\n";

class LongPathTest : public StagesTest, public ::testing::WithParamInterface<std::string> {
 protected:
  // What each command needs to succeed, or to fail for want of markers after all paths were used.
  Options OptionsOf(const std::string& command) {
    const std::string out = path("out");
    if (command == "automatic_reconstructor" || command == "marker_importer") {
      WriteClip();
      Options options = {{"image_path", path("clip.avi")},
                         {"camera_path", path("cameras.txt")},
                         {"dictionary", "DICT_4X4_50"},
                         {"marker_length", "0.1"}};
      options[command == "marker_importer" ? "database_path" : "workspace_path"] = out;
      return options;
    }
    if (command == "clip_checker" || command == "camera_calibrator") {
      WriteClip();
      Options options = {{"image_path", path("clip.avi")}, {"dictionary", "DICT_4X4_50"}};
      if (command == "camera_calibrator") options["output_path"] = out;
      return options;
    }
    if (command == "marker_generator") {
      return {{"dictionary", "DICT_4X4_50"}, {"marker_length", "0.1"}, {"output_path", out}};
    }
    if (command == "shoot_planner") {
      return {{"shape_path", path("shape")}, {"camera_path", WriteCamera()}, {"output_path", out}};
    }
    if (command == "database_merger") {
      return {{"database_paths", path("database.db") + "," + path("database.db")},
              {"dictionary", "DICT_4X4_50"},
              {"marker_length", "0.1"},
              {"output_path", out}};
    }
    if (command == "shape_analyzer") {
      return {{"shape_path", path("shape")}, {"input_path", path("model")}};
    }
    if (command == "shape_comparer") {
      return {{"shape_path", path("shape")}, {"reference_path", path("shape")}};
    }
    Options options = {{"marker_length", "0.1"}};
    options[command == "shape_exporter" ? "shape_path" : "output_path"] = out;
    if (command == "shape_exporter" || command == "bundle_adjuster") {
      options["input_path"] = path("model");
    } else {
      options["database_path"] = path("database.db");
    }
    return options;
  }

  void SetUp() override {
    WriteModel(TrueModel(scene_, kOtherUnit_m), path("model"), ModelFormat::kBinary);
    WriteDatabase(scene_, path("database.db"), 8, All);
    const ProgramRun run = Export();
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }

  std::string WriteCamera() {
    WriteTextFile(dir_ / "cameras.txt", kCamera);
    return path("cameras.txt");
  }

  void WriteClip() {
    WriteCamera();
    const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
    cv::VideoWriter writer(path("clip.avi"), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                           cv::Size(320, 200));
    for (int i = 0; i < 3; ++i) {
      writer << DrawMarkers(dictionary, cv::Size(320, 200),
                            {{1, 20 + i, 40, 72}, {2, 120, 40, 72}});
    }
  }

  // The options whose value is a path, or may be one, by the help.
  static std::vector<std::string> PathOptions(const std::string& command) {
    const std::regex option("  --(\\S+) (name\\|)?path\\b.*");
    std::istringstream help(RunVelamap({command, "--help_all"}).out);
    std::vector<std::string> names;
    std::smatch match;
    for (std::string line; std::getline(help, line);) {
      if (std::regex_match(line, match, option)) names.push_back(match[1]);
    }
    return names;
  }
};

TEST_P(LongPathTest, IsAnInputError) {
  const std::string long_name(300, 'n');
  const std::vector<std::string> names = PathOptions(GetParam());
  EXPECT_GE(names.size(), 4u);
  for (const std::string& name : names) {
    if (name == "surface_path")
      continue;  // needs lines; the file is written as that of output_path
    Options options = OptionsOf(GetParam());
    options[name] = path(long_name);
    // Each way of adjustment reads paths of its own. Without COLMAP its options end with exit
    // code 3.
    const bool is_of_colmap = name == "colmap_path" || name == "log_path";
    if (GetParam() == "bundle_adjuster" || GetParam() == "central_frame_sweeper") {
      options["backend"] = is_of_colmap ? "colmap" : "markers";
    }
    // COLMAP's adjustment knows no markers.
    if (GetParam() == "bundle_adjuster" && is_of_colmap) options.erase("marker_length");
    // A layout names dictionary and length itself. A plan takes one in place of a shape.
    if (name == "layout_path") {
      options.erase("dictionary");
      options.erase("marker_length");
    }
    std::vector<std::string> arguments = {GetParam()};
    for (const auto& [key, value] : options) arguments.insert(arguments.end(), {"--" + key, value});
    const ProgramRun run = RunVelamap(arguments);
    EXPECT_TRUE(run.exit_code == 2 || (is_of_colmap && run.exit_code == 3))
        << name << ": exit code " << run.exit_code << ": " << run.err;
    EXPECT_EQ(NumErrorLines(run.err), 1) << name << ": " << run.err;
    if (!is_of_colmap) {
      EXPECT_THAT(run.err, HasSubstr(long_name)) << name;
    }
    fs::remove_all(dir_ / "out");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Commands, LongPathTest,
    ::testing::Values("automatic_reconstructor", "marker_importer", "frame_registrator",
                      "bundle_adjuster", "central_frame_sweeper", "shape_exporter",
                      "shape_analyzer", "shape_comparer", "clip_checker", "camera_calibrator",
                      "marker_generator", "shoot_planner", "database_merger"),
    [](const ::testing::TestParamInfo<std::string>& test) { return test.param; });

}  // namespace
}  // namespace velamap
