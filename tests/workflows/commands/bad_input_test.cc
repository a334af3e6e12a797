// What happens when the input is wrong: the exit code, one line that names the fault, and nothing
// left behind.

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr char kCamera[] = R"(%YAML:1.0
---
image_width: 320
image_height: 240
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 300., 0., 160., 0., 300., 120., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ 0., 0., 0., 0., 0. ]
)";

// A call of automatic_reconstructor that fails for want of markers only; each test breaks one
// thing.
class BadInputTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(images());
    for (const char* name : {"a.png", "b.png"}) {
      cv::imwrite((images() / name).string(), cv::Mat(240, 320, CV_8UC1, cv::Scalar(128)));
    }
    WriteTextFile(dir_ / "camera.yml", kCamera);
    arguments_ = {{"--image_path", images().string()},
                  {"--camera_path", (dir_ / "camera.yml").string()},
                  {"--workspace_path", workspace().string()},
                  {"--dictionary", "DICT_4X4_50"},
                  {"--marker_length", "0.1"}};
  }

  // Runs, and demands the exit code, one error line with `expected` in it, and that no file but
  // those of before is in the test's folder.
  void ExpectFailure(int exit_code, const std::string& expected) {
    std::vector<std::string> arguments = {"automatic_reconstructor"};
    for (const auto& [name, value] : arguments_) {
      if (value.empty()) continue;
      arguments.insert(arguments.end(), {name, value});
    }
    const std::vector<std::string> before = ListFolder(dir_.path());
    const ProgramRun run = RunVelamap(arguments);
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_THAT(run.err, HasSubstr("error: "));
    EXPECT_THAT(run.err, HasSubstr(expected));
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(ListFolder(dir_.path()), before);
  }

  fs::path images() const { return dir_ / "images"; }
  fs::path workspace() const { return dir_ / "workspace"; }

  TempDir dir_;
  std::map<std::string, std::string> arguments_;
};

TEST_F(BadInputTest, NoMarkerAtAll) { ExpectFailure(1, "no marker of DICT_4X4_50"); }

TEST_F(BadInputTest, MissingImageFolder) {
  arguments_["--image_path"] = (dir_ / "nowhere").string();
  ExpectFailure(2, "nowhere");
}

TEST_F(BadInputTest, EmptyImageFolder) {
  fs::create_directory(dir_ / "empty");
  arguments_["--image_path"] = (dir_ / "empty").string();
  ExpectFailure(2, "empty");
}

TEST_F(BadInputTest, NoFileIsAnImage) {
  for (const char* name : {"a.png", "b.png"}) WriteTextFile(images() / name, "no image");
  ExpectFailure(2, "none of 2 images can be read");
}

TEST_F(BadInputTest, VideoThatIsNone) {
  WriteTextFile(dir_ / "video.mp4", "no video");
  arguments_["--image_path"] = (dir_ / "video.mp4").string();
  ExpectFailure(2, "video.mp4");
}

TEST_F(BadInputTest, MissingOrIncompleteCalibration) {
  arguments_["--camera_path"] = (dir_ / "nowhere.yml").string();
  ExpectFailure(2, "nowhere.yml");
  WriteTextFile(dir_ / "camera.yml", "%YAML:1.0\n---\nimage_width: 320\nimage_height: 240\n");
  arguments_["--camera_path"] = (dir_ / "camera.yml").string();
  ExpectFailure(2, "camera_matrix");
}

TEST_F(BadInputTest, PriorShapeThatIsNone) {
  arguments_["--prior_shape_path"] = (dir_ / "nowhere.csv").string();
  ExpectFailure(2, "nowhere.csv");
  arguments_["--prior_shape_path"] = images().string();
  ExpectFailure(2, "--prior_shape_path: " + (images() / "shape.csv").string());
  const std::string header = "marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part\n";
  WriteTextFile(dir_ / "prior.csv", header + "1,1,0,0,0,,,,2,\n");
  arguments_["--prior_shape_path"] = (dir_ / "prior.csv").string();
  ExpectFailure(2, "no marker has all four corners");
  WriteTextFile(dir_ / "prior.csv", header + "1,1,0,nan,0,,,,2,\n");
  ExpectFailure(2, "prior.csv:2");
}

TEST_F(BadInputTest, CalibrationForAnotherResolution) {
  std::string camera = kCamera;
  camera.replace(camera.find("320"), 3, "400");
  WriteTextFile(dir_ / "camera.yml", camera);
  ExpectFailure(2, "camera.yml");
}

TEST_F(BadInputTest, DictionaryThatDoesNotExist) {
  arguments_["--dictionary"] = "DICT_4X4_51";
  ExpectFailure(2, "DICT_4X4_51");
}

TEST_F(BadInputTest, DictionaryFileWithWrongBits) {
  WriteTextFile(dir_ / "dictionary.yml",
                "%YAML:1.0\n---\nnmarkers: 1\nmarkersize: 3\nmaxCorrectionBits: 0\n"
                "marker_0: \"1010\"\n");
  arguments_["--dictionary"] = (dir_ / "dictionary.yml").string();
  ExpectFailure(2, "marker_0");
}

TEST_F(BadInputTest, MarkerLengthZeroNegativeOrAbsurd) {
  for (const char* length : {"0", "-0.1", "1000", "nan", "ten"}) {
    arguments_["--marker_length"] = length;
    ExpectFailure(2, "--marker_length");
  }
}

TEST_F(BadInputTest, NeitherLayoutNorItsReplacementOrBoth) {
  arguments_["--dictionary"] = "";
  ExpectFailure(2, "--layout_path: missing");
  arguments_["--layout_path"] = (dir_ / "nowhere.yml").string();
  ExpectFailure(2, "leave out");
  arguments_["--marker_length"] = "";
  ExpectFailure(2, "nowhere.yml");
}

TEST_F(BadInputTest, WorkspaceIsAFileOrSomeoneElsesFolder) {
  WriteTextFile(workspace(), "a file");
  ExpectFailure(2, "is a file");
  EXPECT_EQ(ReadFileBytes(workspace()), "a file");
  fs::remove(workspace());
  fs::create_directory(workspace());
  WriteTextFile(workspace() / "thesis.tex", "text");
  ExpectFailure(2, "holds thesis.tex");
}

TEST_F(BadInputTest, WorkspaceThatCannotBeMade) {
  WriteTextFile(dir_ / "file", "a file");
  for (const fs::path& path : {dir_ / "file/workspace", fs::path("/proc/velamap/workspace")}) {
    arguments_["--workspace_path"] = path.string();
    ExpectFailure(2, path.string());
  }
}

TEST_F(BadInputTest, ColmapAbsent) {
  arguments_["--colmap_path"] = (dir_ / "colmap").string();
  ExpectFailure(3, (dir_ / "colmap").string());
}

TEST_F(BadInputTest, ColmapThatIsAnotherProgram) {
  arguments_["--colmap_path"] = "/bin/true";
  ExpectFailure(3, "/bin/true");
}

TEST_F(BadInputTest, OptionsOutOfRange) {
  const std::map<std::string, std::string> bad_values = {
      {"--ArucoDetection.error_correction_rate", "2"},
      {"--ArucoDetection.min_marker_perimeter_rate", "-1"},
      {"--Video.frame_step", "0"},
      {"--Registration.skip", "0"},
      {"--Registration.frequency_threshold", "30"},
      {"--BundleAdjustment.max_num_rounds", "-1"},
      {"--BundleAdjustment.function_tolerance", "-1"},
      {"--num_threads", "-2"},
      {"--random_seed", "-1"}};
  for (const auto& [name, value] : bad_values) {
    arguments_[name] = value;
    ExpectFailure(2, name);
    arguments_.erase(name);
  }
}

}  // namespace
}  // namespace velamap
