// The command clip_checker on photographs, a rendered clip and garbage.

#include <filesystem>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "importer/layout/layout.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

const std::string kCube = std::string(VELAMAP_SOURCE_DIR) + "/sample_project/cube/";
const std::string kSampleSail = std::string(VELAMAP_SOURCE_DIR) + "/sample_project/sail/";

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
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("verdict: "), HasSubstr("ids_never_seen: "),
                    HasSubstr("side_px: median "), HasSubstr("blur_px: "), HasSubstr("precision: "),
                    HasSubstr("parallax_deg: "), Not(HasSubstr("not_checked: "))));
  EXPECT_FALSE(cv::imread(png).empty());
}

TEST_F(ClipCheckerTest, FindsTheDictionaryByItself) {
  const ProgramRun run = RunVelamap({"clip_checker", "--image_path", kCube + "images"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("dictionary: DICT_"), HasSubstr("(found by trying: "),
                             HasSubstr("not_checked: depth, zoom, stabilization\n"),
                             Not(HasSubstr("verdict: good")), Not(HasSubstr("precision: "))));
}

// No frame of the sail shows all its markers, and two of their ids need the next dictionary.
TEST_F(ClipCheckerTest, TheDictionaryHasTheIdsOfAllFrames) {
  const std::string layout = (dir_.path() / "layout.yml").string();
  const ProgramRun run = RunVelamap(
      {"clip_checker", "--image_path", kSampleSail + "clip.mp4", "--proposed_layout_path", layout});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("dictionary: DICT_4X4_250 (found by trying: "),
                    HasSubstr("; no other finds any, beyond chance)"),
                    HasSubstr("markers_seen: 102\nids: 0-101\n"),
                    HasSubstr("\ngood_parts_s: 0.0 to 4.9 (frames 0 to 148: 102 markers)\n"),
                    Not(HasSubstr("poor_parts_s: "))));
  const Layout proposed = ReadLayout(layout);
  EXPECT_EQ(proposed.dictionary, "DICT_4X4_250");
  EXPECT_EQ(MarkerIds(proposed).size(), 102u);
  // As on the sheets and in the layout of marker_generator: ink makes black squares larger.
  EXPECT_THAT(ReadFileBytes(layout),
              AllOf(HasSubstr("# dictionary: found by trying"), HasSubstr("# marker_length: NOT"),
                    HasSubstr("# If the printed scale is not as long as it says"),
                    HasSubstr("do not measure the black squares")));
}

TEST_F(ClipCheckerTest, TheSizesOfTheMarkersReplaceACalibration) {
  const ProgramRun run = RunVelamap(
      {"clip_checker", "--image_path", kCube + "images", "--layout_path", kCube + "layout.yml"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("precision: "), HasSubstr("parallax_deg: "),
                    HasSubstr("camera: found; focal length "), Not(HasSubstr("not_checked: "))));
}

TEST_F(ClipCheckerTest, AnOutputThatCannotBeWrittenIsRefusedBeforeTheWork) {
  fs::create_directory(dir_.path() / "locked");
  fs::permissions(dir_.path() / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  for (const char* option : {"--output_path", "--proposed_layout_path"}) {
    const ProgramRun run = RunVelamap({"clip_checker", "--image_path", kCube + "images", option,
                                       (dir_.path() / "locked" / "new" / "frame.png").string()});
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr("locked: cannot be written: it is write-protected"));
    EXPECT_THAT(run.out, Not(HasSubstr("verdict: ")));
  }
  fs::permissions(dir_.path() / "locked", fs::perms::owner_all);
}

TEST_F(ClipCheckerTest, PicturesWithoutMarkersAreABadClip) {
  fs::create_directory(dir_.path() / "blank");
  cv::imwrite((dir_.path() / "blank" / "a.png").string(), cv::Mat(240, 320, CV_8U, 128));
  const ProgramRun run =
      RunVelamap({"clip_checker", "--image_path", (dir_.path() / "blank").string()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("verdict: bad"), HasSubstr("no marker is seen")));
}

TEST_F(ClipCheckerTest, AMirroredPictureIsNamed) {
  fs::create_directory(dir_.path() / "mirrored");
  for (const char* name : {"cam0_00", "cam0_01", "cam0_02"}) {
    cv::Mat picture = cv::imread(kCube + "images/" + name + ".jpg");
    ASSERT_FALSE(picture.empty()) << name;
    cv::flip(picture, picture, 1);
    cv::imwrite((dir_.path() / "mirrored" / name).string() + ".png", picture);
  }
  const ProgramRun run =
      RunVelamap({"clip_checker", "--image_path", (dir_.path() / "mirrored").string(),
                  "--layout_path", kCube + "layout.yml"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("verdict: bad"), HasSubstr("only in the mirrored image"),
                             HasSubstr("markers_seen: 0\n"), HasSubstr("ids_never_seen: 0-299\n")));
}

TEST_F(ClipCheckerTest, TheLayoutOfAnotherObjectIsBad) {
  const std::string sample = std::string(VELAMAP_SOURCE_DIR) + "/sample_project/";
  const ProgramRun run = RunVelamap({"clip_checker", "--image_path", sample + "stylus/images",
                                     "--layout_path", sample + "sail/layout.yml"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("verdict: bad"),
                             HasSubstr("the layout or the dictionary does not belong to these"),
                             Not(HasSubstr("mirrored"))));
}

TEST_F(ClipCheckerTest, WrongLayoutsAreRefusedWithTheirLineOrKey) {
  const std::string path = (dir_.path() / "layout.yml").string();
  const auto expect = [&](const std::string& text, const std::string& message) {
    WriteTextFile(path, text);
    const ProgramRun run =
        RunVelamap({"clip_checker", "--image_path", kCube + "images", "--layout_path", path});
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr("error: " + path + message));
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
  };
  expect("dictionary: DICT_4X4_55\nmarker_length: 0.1\n",
         ": key 'dictionary': dictionary 'DICT_4X4_55': neither a file nor one of DICT_4X4_50");
  expect("dictionary: DICT_4X4_50\nmarker_length: 100\n",
         ":2: marker_length: 100 m is not a marker side; give the outer edge of the black square "
         "in metres, 0.0001 to 10 (0.1 for 100 mm)");
  expect("dictionary: DICT_4X4_50\nmarker_length: 0.1\nparts:\n  sail: {markers: [1, 2, 2]}\n",
         ":4: parts.sail.markers[2]: marker 2 is named twice in this list");
}

TEST_F(ClipCheckerTest, WhatIsNoClipIsAnInputError) {
  EXPECT_EQ(RunVelamap({"clip_checker", "--image_path", kCube + "layout.yml"}).exit_code, 2);
  EXPECT_EQ(RunVelamap({"clip_checker", "--image_path", kCube + "missing"}).exit_code, 2);
  EXPECT_EQ(RunVelamap({"clip_checker"}).exit_code, 2);
}

}  // namespace
}  // namespace velamap
