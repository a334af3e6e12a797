#include "importer/print/marker_sheets.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/print/print_plan.h"
#include "importer/text/text_file.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class PrintMarkersTest : public testing::Test {
 protected:
  PrintMarkersTest() { options_.marker_length_m = 0.05; }

  PrintReport Print() { return PrintMarkers(options_, Folder()); }
  std::string Folder() const { return dir_ / "out"; }
  std::string Read(const std::string& name) const {
    return ReadTextFile((dir_ / "out" / name).string(), "");
  }
  void MakeSail() {
    options_.arrangement = Arrangement::kSail;
    options_.sail.luff_m = 6;
    options_.sail.foot_m = 3;
    options_.sail.leech_m = 6.2;
    options_.sail.hull_markers = 8;
  }
  void ExpectError(std::initializer_list<std::string> parts) {
    ExpectThrows<InputError>([&] { Print(); }, parts);
    EXPECT_FALSE(fs::exists(Folder()));
  }

  TempDir dir_;
  PrintOptions options_;
};

TEST_F(PrintMarkersTest, SailHasLayoutWithHullAndDrawing) {
  MakeSail();
  const PrintReport report = Print();
  EXPECT_THAT(report.files, ElementsAre("layout.yml", "placement.svg", "sheets.pdf"));
  const Layout layout = ReadLayout(dir_ / "out/layout.yml");
  EXPECT_EQ(layout.dictionary, "DICT_4X4_250");
  EXPECT_EQ(layout.marker_length_m, 0.05);
  ASSERT_EQ(layout.parts.size(), 2u);
  EXPECT_EQ(layout.parts[0].horizontal.size(), 7u);
  EXPECT_EQ(layout.parts[0].horizontal[0].marker_ids.size(), 12u);
  EXPECT_TRUE(layout.parts[1].rigid);
  EXPECT_EQ(layout.parts[1].marker_ids.size(), 8u);
  EXPECT_EQ(layout.reference_part, "hull");
  const std::vector<int> ids = MarkerIds(layout);
  EXPECT_EQ(report.num_markers, static_cast<int>(ids.size()));
  EXPECT_EQ(ids.back(), static_cast<int>(ids.size()) - 1);
}

TEST_F(PrintMarkersTest, SameOptionsSameBytes) {
  MakeSail();
  options_.codes.bits_per_side = 4;
  Print();
  // cairo's cache of fonts moves letters of a second SVG of one process by 1e-6 mm.
  const std::vector<std::string> names = {"sheets.pdf", "dictionary.yml", "layout.yml"};
  std::vector<std::string> before;
  for (const std::string& name : names) before.push_back(Read(name));
  Print();
  for (std::size_t i = 0; i < names.size(); ++i)
    EXPECT_TRUE(Read(names[i]) == before[i]) << names[i];
  EXPECT_EQ(before[0].find("/CreationDate (D:2"), std::string::npos);
}

TEST_F(PrintMarkersTest, OwnDictionaryIsFoundFromTheLayout) {
  options_.codes.bits_per_side = 5;
  options_.num_markers = 20;
  const PrintReport report = Print();
  ASSERT_TRUE(report.codes.has_value());
  EXPECT_EQ(report.dictionary, "OWN_5X5_20");
  const Layout layout = ReadLayout(dir_ / "out/layout.yml");
  const Dictionary dictionary = LoadDictionary(layout.dictionary);
  EXPECT_EQ(NumMarkers(dictionary), 20);
  EXPECT_FALSE(layout.HasMarkers());
}

TEST_F(PrintMarkersTest, ThesisDictionaryAndLostMarkers) {
  options_.dictionary = "THESIS_3X3_130";
  options_.num_markers = 130;
  options_.ids = {3, 129};
  const PrintReport report = Print();
  EXPECT_EQ(report.num_markers, 2);
  EXPECT_EQ(NumMarkers(LoadDictionary(ReadLayout(dir_ / "out/layout.yml").dictionary)), 130);
}

TEST_F(PrintMarkersTest, MarkersOfALayoutKeepTheirSizes) {
  MakeSail();
  Print();
  const std::string path = dir_ / "edited.yml";
  std::ofstream(path) << Read("layout.yml") << "marker_lengths: {3: 0.02}\n";
  options_ = PrintOptions();
  options_.layout = ReadLayout(path);
  options_.layout_path = path;
  const PrintReport report = Print();
  EXPECT_THAT(report.files, ElementsAre("sheets.pdf"));
  const PrintPlan plan = MakePrintPlan(options_);
  EXPECT_EQ(plan.markers[3].length_mm, 20);
  EXPECT_EQ(plan.markers[3].place, "sail h1, 4 of 12");
  EXPECT_EQ(plan.markers.back().place, "hull");
}

// A printer makes 49.75 mm of the 50 mm of the first sheets, and has to make the same of a reprint.
TEST_F(PrintMarkersTest, ReprintOfACorrectedLayoutIsDrawnAsTheFirstSheets) {
  MakeSail();
  Print();
  const std::string path = dir_ / "edited.yml";
  std::string text = Read("layout.yml");
  const std::string written = "marker_length: 0.05";
  ASSERT_NE(text.find("\n" + written), std::string::npos);
  text.replace(text.find("\n" + written) + 1, written.size(), "marker_length: 0.04975");
  std::ofstream(path) << text << "marker_lengths: {3: 0.0199}\n";
  options_ = PrintOptions();
  options_.layout = ReadLayout(path);
  options_.layout_path = path;
  EXPECT_EQ(options_.layout->marker_length_m, 0.04975);
  const PrintPlan plan = MakePrintPlan(options_);
  EXPECT_NEAR(plan.markers[0].length_mm, 50, 1e-9);
  EXPECT_NEAR(plan.markers[3].length_mm, 20, 1e-9);
  EXPECT_EQ(Print().drawn_length_mm, 50);
}

TEST_F(PrintMarkersTest, DrawnLengthThatNoPrinterChangesSoMuchIsRefused) {
  options_ = PrintOptions();
  options_.layout = MakeLayout("DICT_4X4_50", 0.05);
  options_.layout->drawn_length_m = 0.1;
  options_.layout_path = "layout.yml";
  options_.ids = {3};
  ExpectError({"--layout_path", "drawn_length", "layout.yml", "leave the key out"});
}

TEST_F(PrintMarkersTest, BoardsAreOnePageWithARigidLayout) {
  options_.marker_length_m.reset();
  for (const Arrangement arrangement : {Arrangement::kBoard, Arrangement::kCharuco}) {
    options_.arrangement = arrangement;
    const PrintReport report = Print();
    EXPECT_EQ(report.num_sheets, 1);
    EXPECT_THAT(report.files, ElementsAre("board.svg", "layout.yml", "sheets.pdf"));
    const Layout layout = ReadLayout(dir_ / "out/layout.yml");
    EXPECT_TRUE(layout.parts.at(0).rigid);
    EXPECT_EQ(static_cast<int>(MarkerIds(layout).size()), report.num_markers);
    EXPECT_EQ(report.num_markers, arrangement == Arrangement::kBoard ? 35 : 17);
  }
}

TEST_F(PrintMarkersTest, SingleMarkersOnRequest) {
  options_.ids = {4, 17};
  options_.sheet.write_png = options_.sheet.write_svg = true;
  EXPECT_THAT(Print().files,
              ElementsAre("layout.yml", "markers/marker_0004.png", "markers/marker_0004.svg",
                          "markers/marker_0017.png", "markers/marker_0017.svg", "sheets.pdf"));
  EXPECT_THAT(Read("markers/marker_0004.svg"), HasSubstr("width=\"75mm\""));
}

TEST_F(PrintMarkersTest, BadInputNamesTheOptionAndWritesNothing) {
  ExpectError({"--num_markers: missing"});
  options_.num_markers = 251;
  ExpectError({"--dictionary", "marker 250", "DICT_4X4_250 has 250 codes"});
  options_.num_markers = 3;
  options_.sheet.paper = {"60x60", 60, 60};
  ExpectError({"--Sheet.paper: 60x60", "too small"});
  options_.sheet.paper = {"A4"};
  options_.dictionary = "DICT_9X9";
  ExpectError({"'DICT_9X9'", "THESIS_3X3_130"});
  options_.codes.bits_per_side = 3;
  ExpectError({"--dictionary", "--CustomDictionary.bits"});
  options_.dictionary.clear();
  options_.num_markers = 130;
  ExpectError({"--CustomDictionary.bits", "120", "allow_symmetric"});
  options_.codes = {5, 20};
  ExpectError({"--CustomDictionary.size", "marker 129", "20 codes"});
  options_.codes = {};
  options_.ids = {200};
  ExpectError({"--ids: marker 200"});
  options_.ids.clear();
  options_.sail.luff_m = 6;
  ExpectError({"--Sail.luff", "--arrangement sail"});
  options_.sail.luff_m.reset();
  options_.sail.foot_m = 3;
  ExpectError({"--Sail.foot: ", "--arrangement sail"});
  options_.sail.foot_m.reset();
  options_.codes.allow_symmetric = true;
  ExpectError({"--CustomDictionary.allow_symmetric: ", "--CustomDictionary.bits is 0"});
  options_.codes = {};
  options_.marker_length_m.reset();
  ExpectError({"--marker_length: missing"});
  options_.marker_length_m = 0.05;
  options_.first_id = 8190;
  ExpectError({"--first_id", "8191"});
  options_.first_id = options_.num_markers = 0;
  options_.arrangement = Arrangement::kGrid;
  options_.grid.num_rows = options_.grid.num_columns = 100;
  ExpectError({"--Grid.rows: 100 rows x 100 columns", "9999", "DICT_4X4_250 has 250 codes",
               "DICT_4X4_1000"});
  options_.grid.num_rows = options_.grid.num_columns = 20;
  ExpectError({"--Grid.rows: 20 rows x 20 columns", "marker 399", "DICT_4X4_250 has 250 codes",
               "a larger dictionary"});
}

TEST_F(PrintMarkersTest, TheDictionaryOfALayoutIsBlamedOnTheLayout) {
  options_ = {};
  options_.layout = MakeLayout("DICT_4X4_50", 0.05);
  options_.layout_path = "sail.yml";
  options_.ids = {50};
  ExpectError({"--layout_path: key 'dictionary' of sail.yml: marker 50", "has 50 codes"});
}

TEST_F(PrintMarkersTest, FoldersOfOthersStayAsTheyAre) {
  options_.num_markers = 1;
  fs::create_directory(Folder());
  std::ofstream(dir_ / "out/sheets.pdf") << "mine";
  ExpectThrows<InputError>([&] { Print(); }, {Folder(), "sheets.pdf"});
  EXPECT_EQ(Read("sheets.pdf"), "mine");
}

}  // namespace
}  // namespace velamap
