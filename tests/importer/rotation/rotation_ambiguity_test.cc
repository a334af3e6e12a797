#include "importer/rotation/rotation_ambiguity.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/importer/marker_builders.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

Dictionary DictionaryOf(const std::vector<std::string>& codes) {
  const int size = static_cast<int>(std::lround(std::sqrt(codes[0].size())));
  cv::Mat bytes;
  for (const std::string& code : codes) {
    cv::Mat bits(size, size, CV_8UC1);
    for (int i = 0; i < size * size; ++i) {
      bits.data[i] = static_cast<std::uint8_t>(code[static_cast<std::size_t>(i)] - '0');
    }
    bytes.push_back(cv::aruco::Dictionary::getByteListFromBits(bits));
  }
  return {"test", cv::makePtr<cv::aruco::Dictionary>(bytes, size, 0)};
}

TEST(FindCodeSymmetries, NamesTheTurnsThatLeaveACode) {
  const Dictionary dictionary = DictionaryOf({"110000000", "100000001", "101000101", "010101010"});
  EXPECT_THAT(FindCodeSymmetries(dictionary),
              ElementsAre(Pair(1, ElementsAre(2)), Pair(2, ElementsAre(1, 2, 3)),
                          Pair(3, ElementsAre(1, 2, 3))));
}

TEST(FindCodeSymmetries, PredefinedDictionariesHaveNone) {
  for (const char* name : {"DICT_4X4_1000", "DICT_6X6_250", "DICT_APRILTAG_36h11"}) {
    EXPECT_TRUE(FindCodeSymmetries(LoadDictionary(name)).empty()) << name;
  }
}

TEST(ResolveRotations, HalfTurnIsUndoneHoweverTheFrameIsTurned) {
  const CodeSymmetries symmetries = {{5, {2}}};
  for (const double frame_deg : {0.0, 90.0, 200.0}) {
    for (const int reported_from : {0, 2}) {
      std::vector<MarkerDetection> markers = {TurnedMarker(1, 100, 100, frame_deg + 10),
                                              TurnedMarker(2, 200, 100, frame_deg - 15),
                                              TurnedMarker(5, 150, 100, frame_deg, reported_from)};
      std::vector<RejectedDetection> rejected;
      ResolveRotations(symmetries, {}, &markers, &rejected);
      ASSERT_EQ(markers.size(), 3u);
      const MarkerDetection truth = TurnedMarker(5, 150, 100, frame_deg);
      for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(markers[2].corners_in_image_px[i], truth.corners_in_image_px[i]);
        EXPECT_EQ(markers[2].colors[i], truth.colors[i]);
        EXPECT_EQ(markers[2].corner_sigma_px[i], truth.corner_sigma_px[i]);
      }
    }
  }
}

TEST(ResolveRotations, GraphTellsWhichNeighboursCount) {
  // Marker 1 is adjacent and stands upside down; 2 and 3 are nearer in the image only.
  const AdjacencyGraph graph = {{1, {5}}, {5, {1}}, {2, {3}}, {3, {2}}};
  std::vector<MarkerDetection> markers = {
      TurnedMarker(1, 400, 100, 180), TurnedMarker(2, 130, 100, 0), TurnedMarker(3, 170, 100, 0),
      TurnedMarker(5, 150, 100, 0)};
  std::vector<RejectedDetection> rejected;
  ResolveRotations({{5, {2}}}, graph, &markers, &rejected);
  EXPECT_EQ(markers[3].colors[0][0], 2);
}

TEST(ResolveRotations, DoubtfulMarkersAreLeftOut) {
  const CodeSymmetries symmetries = {{5, {2}}, {6, {1, 2, 3}}};
  std::vector<RejectedDetection> rejected;
  std::vector<MarkerDetection> alone = {TurnedMarker(5, 150, 100, 0), TurnedMarker(6, 180, 100, 0)};
  ResolveRotations(symmetries, {}, &alone, &rejected);
  EXPECT_TRUE(alone.empty());
  EXPECT_EQ(rejected.size(), 2u);

  rejected.clear();
  std::vector<MarkerDetection> across = {TurnedMarker(1, 100, 100, 85),
                                         TurnedMarker(5, 150, 100, 0)};
  ResolveRotations(symmetries, {}, &across, &rejected);
  EXPECT_EQ(across.size(), 1u);

  rejected.clear();
  std::vector<MarkerDetection> quarter = {TurnedMarker(1, 100, 100, 40),
                                          TurnedMarker(6, 150, 100, 0)};
  ResolveRotations(symmetries, {}, &quarter, &rejected);
  ASSERT_EQ(rejected.size(), 1u);
  EXPECT_EQ(rejected[0].reason, kDoubtfulRotation);
}

}  // namespace
}  // namespace velamap
