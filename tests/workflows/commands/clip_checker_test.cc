// The command clip_checker on photographs, a rendered clip and garbage.

#include <filesystem>

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

const std::string kCube = std::string(VELAMAP_SOURCE_DIR) + "/sample_project/cube/";

class ClipCheckerTest : public testing::Test {
 protected:
  TempDir dir_;
};

TEST_F(ClipCheckerTest, SaysWhatTheCubesPhotographsAreWorth) {
  const std::string png = (dir_.path() / "frame.png").string();
  const ProgramRun run = RunVelamap({"clip_checker", "--image_path", kCube + "images",
                                     "--layout_path", kCube + "layout.yml", "--camera_path",
                                     kCube + "camera.yml", "--output_path", png});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("verdict: "), HasSubstr("ids_never_seen: "),
                             HasSubstr("side_px: median "), HasSubstr("blur_px: "),
                             HasSubstr("precision: "), HasSubstr("parallax_deg: ")));
  EXPECT_FALSE(cv::imread(png).empty());
}

TEST_F(ClipCheckerTest, FindsTheDictionaryByItself) {
  const ProgramRun run = RunVelamap({"clip_checker", "--image_path", kCube + "images"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("dictionary: DICT_"), HasSubstr("(found: "),
                             Not(HasSubstr("precision: "))));
}

TEST_F(ClipCheckerTest, PicturesWithoutMarkersAreABadClip) {
  fs::create_directory(dir_.path() / "blank");
  cv::imwrite((dir_.path() / "blank" / "a.png").string(), cv::Mat(240, 320, CV_8U, 128));
  const ProgramRun run =
      RunVelamap({"clip_checker", "--image_path", (dir_.path() / "blank").string()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("verdict: bad"), HasSubstr("no marker is seen")));
}

TEST_F(ClipCheckerTest, WhatIsNoClipIsAnInputError) {
  EXPECT_EQ(RunVelamap({"clip_checker", "--image_path", kCube + "layout.yml"}).exit_code, 2);
  EXPECT_EQ(RunVelamap({"clip_checker", "--image_path", kCube + "missing"}).exit_code, 2);
  EXPECT_EQ(RunVelamap({"clip_checker"}).exit_code, 2);
}

}  // namespace
}  // namespace velamap
