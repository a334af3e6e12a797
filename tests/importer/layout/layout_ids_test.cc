// Lists of marker ids in a layout: numbers and ranges of them.

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/layout/layout.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using testing::ElementsAre;

class LayoutIds : public testing::Test {
 protected:
  // `text` begins in line 3.
  Layout Read(const std::string& text) const {
    std::ofstream(path_) << "dictionary: DICT_4X4_100\nmarker_length: 0.100\n" << text;
    return ReadLayout(path_);
  }

  void ExpectError(const std::string& text, int line, const std::string& part) const {
    ExpectThrows<InputError>([&] { Read(text); },
                             {path_ + ":" + std::to_string(line) + ": ", part});
  }

  const std::string& path() const { return path_; }

 private:
  TempDir dir_;
  const std::string path_ = (dir_ / "layout.yml").string();
};

TEST_F(LayoutIds, RangesStandBesideNumbersAndRunUpOrDown) {
  const Layout layout = Read(R"(marker_lengths: {40-42: 0.050, 7: 0.2}
parts:
  sail:
    horizontal:
      - {name: h1, markers: [0-3, 7, 12-10]}
      - {name: h2, markers: [16-13]}
    vertical:
      - name: v1
        markers:
          - 3
          - 13-14
    markers: [30-31]
  hull: {markers: [40-42], rigid: true}
)");
  const LayoutPart& sail = layout.parts.at(0);
  EXPECT_THAT(sail.horizontal.at(0).marker_ids, ElementsAre(0, 1, 2, 3, 7, 12, 11, 10));
  EXPECT_THAT(sail.horizontal.at(1).marker_ids, ElementsAre(16, 15, 14, 13));
  EXPECT_THAT(sail.vertical.at(0).marker_ids, ElementsAre(3, 13, 14));
  EXPECT_THAT(sail.marker_ids, ElementsAre(30, 31));
  EXPECT_THAT(layout.parts.at(1).marker_ids, ElementsAre(40, 41, 42));
  EXPECT_EQ(MarkerLength(layout, 41), 0.05);
  EXPECT_EQ(MarkerLength(layout, 7), 0.2);
  EXPECT_EQ(MarkerLength(layout, 43), 0.1);
}

TEST_F(LayoutIds, FileLineAndKeyOfABadRangeAreNamed) {
  for (const std::string range : {"5-", "3-99999", "a-b", "1-2-3", "1 - 4"}) {
    ExpectError("parts:\n  sail:\n    markers: [1, " + range + "]\n", 5,
                "parts.sail.markers[1]: '" + range +
                    "' is not a marker id or a range of them such as 0-16; expected whole numbers "
                    "from 0 to 8191");
  }
  ExpectError("marker_lengths: {4-: 0.2}\n", 3, "'4-' is not a marker id or a range of them");
}

TEST_F(LayoutIds, OverlapsAreFoundInRanges) {
  ExpectError("parts:\n  sail:\n    markers: [4, 7-3]\n", 5,
              "parts.sail.markers[1]: marker 4 is named twice");
  ExpectError("parts:\n  sail: {markers: [0-9]}\n  hull: {markers: [12-8]}\n", 5,
              "marker 9 is in part 'sail' already");
  ExpectError("marker_lengths: {4-6: 0.2, 5: 0.3}\n", 3,
              "marker_lengths.5: marker 5 is given a second length");
}

// A mistyped id, which would bend the line to where that marker really is.
TEST_F(LayoutIds, AMarkerIsOnOneHorizontalLine) {
  ExpectError(
      "parts:\n  sail:\n    horizontal:\n      - {name: h1, markers: [0-3]}\n"
      "      - {name: h2, markers: [17, 3, 19]}\n",
      7,
      "parts.sail.horizontal[1]: marker 3 is on line 'h2' and on line 'h1' (" + path() +
          ":6); a marker is on one horizontal line: correct its id where it is wrong");
  // Each on its own line of the file, and with a line between.
  ExpectError(
      "parts:\n  sail:\n    horizontal:\n      - name: h1\n        markers: [0, 1]\n"
      "      - {name: h2, markers: [5-7]}\n      - name: h3\n        markers: [10-12, 1]\n",
      9, "marker 1 is on line 'h3' and on line 'h1' (" + path() + ":6)");
}

TEST_F(LayoutIds, LinesMeetInAMarker) {
  // The luff and the leech of a triangle end at its head, on the highest horizontal line.
  const Layout layout = Read(R"(parts:
  sail:
    horizontal:
      - {name: h1, markers: [0-3]}
      - {name: h2, markers: [4-5]}
      - {name: h3, markers: [9]}
    vertical:
      - {name: luff, markers: [0, 4, 9]}
      - {name: leech, markers: [3, 5, 9]}
)");
  EXPECT_EQ(layout.parts.at(0).horizontal.size(), 3u);
  EXPECT_THAT(layout.parts.at(0).vertical.at(1).marker_ids, ElementsAre(3, 5, 9));
}

}  // namespace
}  // namespace velamap
