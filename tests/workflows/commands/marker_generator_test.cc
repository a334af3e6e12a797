// marker_generator as a user calls it: what it prints, and what it says of bad input.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class MarkerGeneratorTest : public ::testing::Test {
 protected:
  ProgramRun Run(std::vector<std::string> arguments, const ProgramLimits& limits = {}) const {
    arguments.insert(arguments.begin(), {"marker_generator", "--output_path", Folder()});
    return RunVelamap(arguments, limits);
  }
  // One line, exit 2, and the test's folder as it was.
  void ExpectFailure(const std::vector<std::string>& arguments, const std::string& expected,
                     const ProgramLimits& limits = {}) const {
    const std::vector<std::string> before = ListFolder(dir_.path());
    const ProgramRun run = Run(arguments, limits);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr("error: "));
    EXPECT_THAT(run.err, HasSubstr(expected));
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(ListFolder(dir_.path()), before);
  }
  std::string Folder() const { return dir_ / "out"; }

  TempDir dir_;
};

const std::vector<std::string> kThree = {"--num_markers", "3", "--marker_length", "0.05"};

std::vector<std::string> Three(std::vector<std::string> more) {
  more.insert(more.end(), kThree.begin(), kThree.end());
  return more;
}

TEST_F(MarkerGeneratorTest, SaysWhatItMade) {
  const ProgramRun run = Run(Three({"--CustomDictionary.bits", "4", "--random_seed", "3"}));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("dictionary: OWN_4X4_3 (3 codes)\ndictionary_distance: "));
  EXPECT_THAT(run.out, HasSubstr("markers: 3\npaper: A4\nsheets: 1\n"));
  EXPECT_THAT(run.out, HasSubstr("white_margin_mm: 12.5\n"));
  EXPECT_THAT(run.out, EndsWith("next: print sheets.pdf at 100 % and measure the scale on the "
                                "sheets\n"));
  EXPECT_THAT(ListFolder(Folder()),
              ElementsAre(".velamap", "dictionary.yml", "layout.yml", "sheets.pdf"));
}

TEST_F(MarkerGeneratorTest, SaysOnWhichPagesTheDrawingIs) {
  const ProgramRun run = Run({"--arrangement", "sail", "--Sail.luff", "6", "--Sail.foot", "3",
                              "--Sail.leech", "6.2", "--marker_length", "0.1"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("\ndrawing: pages 1-2 (where the markers go)\n"));
}

// A length that was measured must not be shrunk by the printer a second time.
TEST_F(MarkerGeneratorTest, ReprintOfMeasuredMarkersSaysWhatIsDrawn) {
  const std::string path = dir_ / "measured.yml";
  WriteTextFile(path, "dictionary: DICT_4X4_50\nmarker_length: 0.0995\n");
  const ProgramRun unsure = Run({"--layout_path", path, "--ids", "3"});
  EXPECT_EQ(unsure.exit_code, 0) << unsure.err;
  EXPECT_THAT(unsure.err, HasSubstr("with the 99.5 mm of key 'marker_length'"));
  EXPECT_THAT(unsure.err, HasSubstr("'drawn_length: 0.1' (m), to " + path));
  WriteTextFile(path, "dictionary: DICT_4X4_50\nmarker_length: 0.0995\ndrawn_length: 0.1\n");
  const ProgramRun sure = Run({"--layout_path", path, "--ids", "3"});
  EXPECT_EQ(sure.exit_code, 0) << sure.err;
  EXPECT_EQ(sure.err.find("drawn_length"), std::string::npos) << sure.err;
  EXPECT_THAT(sure.out, HasSubstr("drawn_length_mm: 100 (the printer that made 99.5 mm of it"));
}

TEST_F(MarkerGeneratorTest, BadWishes) {
  ExpectFailure(Three({"--Sheet.paper", "70x70"}),
                "--Sheet.paper: 70x70 is too small for marker 0");
  ExpectFailure(Three({"--dictionary", "DICT_4X4_50", "--first_id", "48"}),
                "marker 50 is wanted, but DICT_4X4_50 has 50 codes");
  ExpectFailure({"--CustomDictionary.bits", "3", "--num_markers", "130", "--marker_length", "0.05"},
                "3x3 bits have 120 that look different when turned");
  ExpectFailure({"--arrangement", "sail", "--marker_length", "0.1", "--Sail.luff", "6",
                 "--Sail.foot", "3", "--Sail.leech", "12"},
                "is not a triangle");
  ExpectFailure({"--arrangement", "board", "--marker_length", "0.1"}, "too small for a board");
  ExpectFailure(Three({"--layout_path", dir_ / "no.yml"}), "no.yml");
}

TEST_F(MarkerGeneratorTest, FullDiskLeavesNothing) {
  ProgramLimits limits;
  limits.max_file_size = 2000;
  ExpectFailure(kThree, "sheets.pdf: cannot be written", limits);
}

TEST_F(MarkerGeneratorTest, OutputOfOthersStays) {
  WriteTextFile(dir_ / "out", "a file");
  ExpectFailure(kThree, "is not a folder");
  std::filesystem::remove(dir_ / "out");
  std::filesystem::create_directory(Folder());
  WriteTextFile(dir_ / "out/sheets.pdf", "mine");
  ExpectFailure(kThree, "holds sheets.pdf, which velamap did not write there");
  EXPECT_EQ(ReadFileBytes(dir_ / "out/sheets.pdf"), "mine");
  std::filesystem::remove(dir_ / "out/sheets.pdf");
  ASSERT_EQ(Run(kThree).exit_code, 0);
  ASSERT_EQ(Run(kThree).exit_code, 0);
  ExpectFailure({"--layout_path", dir_ / "out/layout.yml"}, "out/layout.yml");  // is replaced
  WriteTextFile(dir_ / "out/layout.yml", "edited");
  ExpectFailure(kThree, "layout.yml, which was changed after velamap wrote it");
}

}  // namespace
}  // namespace velamap
