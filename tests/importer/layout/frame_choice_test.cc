#include "importer/layout/frame_choice.h"

#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/layout/layout.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

std::string WriteLayoutWithFrame(const TempDir& dir, const std::string& frame) {
  const std::string path = dir / "layout.yml";
  std::ofstream(path) << R"(dictionary: DICT_4X4_100
marker_length: 0.1
parts:
  sail:
    horizontal:
      - {name: h1, markers: [1, 2, 3]}
  hull: {markers: [20, 21], rigid: true}
reference_part: hull
)" << frame << '\n';
  return path;
}

TEST(ParseFrameChoice, ReadsKeywordsAndMarkers) {
  EXPECT_EQ(ParseFrameChoice("reference_part", "--frame").kind, FrameKind::kReferencePart);
  EXPECT_EQ(ParseFrameChoice("lines", "--frame").kind, FrameKind::kLines);
  EXPECT_EQ(ParseFrameChoice("camera", "--frame").kind, FrameKind::kCamera);
  EXPECT_EQ(ParseFrameChoice("known_points", "--frame").kind, FrameKind::kKnownPoints);
  const FrameChoice choice = ParseFrameChoice("12,0,40", "--frame");
  EXPECT_EQ(choice.kind, FrameKind::kMarkers);
  EXPECT_EQ(choice.origin_id, 12);
  EXPECT_EQ(choice.axis_id, 0);
  EXPECT_EQ(choice.plane_id, 40);
}

TEST(ParseFrameChoice, RefusesEverythingElse) {
  for (const char* text : {"", "hull", "Lines", "1,2", "1,2,3,4", "1,2,2", "1,2,", "1, 2,3",
                           "1,2,x", "1,2,-3", "1,2,99999"}) {
    ExpectThrows<InputError>([&] { ParseFrameChoice(text, "--frame"); },
                             {"--frame: '" + std::string(text) + "' is not a frame", "12,15,40"});
  }
}

TEST(FrameKeyword, IsWhatIsParsed) {
  for (const FrameKind kind : {FrameKind::kKnownPoints, FrameKind::kReferencePart,
                               FrameKind::kLines, FrameKind::kCamera}) {
    FrameKind parsed = FrameKind::kMarkers;
    ASSERT_TRUE(ParseFrameKeyword(FrameKeyword(kind), &parsed));
    EXPECT_EQ(parsed, kind);
  }
  EXPECT_THROW(FrameKeyword(FrameKind::kMarkers), std::logic_error);
}

TEST(ReadLayout, ReadsTheFrame) {
  const TempDir dir;
  EXPECT_FALSE(ReadLayout(WriteLayoutWithFrame(dir, "")).frame);
  EXPECT_EQ(ReadLayout(WriteLayoutWithFrame(dir, "frame: lines")).frame->kind, FrameKind::kLines);
  EXPECT_EQ(ReadLayout(WriteLayoutWithFrame(dir, "frame: reference_part")).frame->kind,
            FrameKind::kReferencePart);
  const Layout layout =
      ReadLayout(WriteLayoutWithFrame(dir, "frame: {origin: 1, axis: 3, plane: 20}"));
  EXPECT_EQ(layout.frame->kind, FrameKind::kMarkers);
  EXPECT_EQ(layout.frame->plane_id, 20);
}

TEST(ReadLayout, RefusesBadFrames) {
  const TempDir dir;
  const auto expect = [&](const std::string& frame, const std::string& problem) {
    ExpectThrows<InputError>([&] { ReadLayout(WriteLayoutWithFrame(dir, frame)); },
                             {"layout.yml:9: frame", problem});
  };
  expect("frame: markers", "'markers' is not a frame");
  expect("frame: [1, 2, 3]", "is not a frame");
  expect("frame: {origin: 1, axis: 3}", "key 'plane' is missing");
  expect("frame: {origin: 1, axis: 3, plane: 3}", "three different markers");
  expect("frame: {origin: 1, axis: 3, plane: 77}", "marker 77 is in no part");
  expect("frame: {origin: 1, axis: 3, plain: 2}", "unknown key");
  expect("frame: {origin: 1, axis: x, plane: 2}", "'x' is not a marker id");
  const std::string path = dir / "flat.yml";
  std::ofstream(path) << "dictionary: D\nmarker_length: 0.1\nframe: lines\n";
  ExpectThrows<InputError>([&] { ReadLayout(path); }, {"flat.yml:3: frame", "horizontal lines"});
  std::ofstream(path) << "dictionary: D\nmarker_length: 0.1\nframe: reference_part\n";
  ExpectThrows<InputError>([&] { ReadLayout(path); },
                           {"flat.yml:3: frame", "needs the key 'reference_part'"});
}

}  // namespace
}  // namespace velamap
