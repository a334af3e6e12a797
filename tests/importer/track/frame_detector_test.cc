#include "importer/track/frame_detector.h"

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

// The part is rigid, so that all of its markers are neighbours whatever its line.
std::string Describe(SearchMode search, const std::vector<int>& line) {
  Layout layout = MakeLayout("DICT_4X4_50", 0.1);
  layout.parts.push_back({"board", true, {{"h1", line}}, {}, {}});
  ArucoDetectionOptions options;
  options.search = search;
  return DescribeDetector(MakeFrameDetector(layout, options));
}

TEST(DescribeDetector, NamesTheLinesThatATrackedSearchFollows) {
  const SearchMode tracked = SearchMode::kTracked, exhaustive = SearchMode::kExhaustive;
  EXPECT_EQ(Describe(tracked, {1, 2, 3}), Describe(tracked, {1, 2, 3}));
  EXPECT_NE(Describe(tracked, {1, 2, 3}), Describe(tracked, {2, 1, 3}));
  EXPECT_EQ(Describe(exhaustive, {1, 2, 3}), Describe(exhaustive, {2, 1, 3}));
}

TEST(DescribeDetector, OnlyTheSettingsThatDifferAreNamed) {
  const std::string before = "dictionary=a border_bits=1 inverted=0 layout=12";
  const std::string now = "dictionary=a border_bits=1 inverted=1 layout=123 map=7";
  EXPECT_EQ(SettingsThatDiffer(before, now), "inverted=0 layout=12");
  EXPECT_EQ(SettingsThatDiffer(now, before), "inverted=1 layout=123 map=7");
  EXPECT_EQ(SettingsThatDiffer("a=1", "a=1 b=2"), "none of these");
}

PriorShape RowOfMarkers(const std::vector<int>& ids) {
  PriorShape prior;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const double x = 0.3 * static_cast<double>(i);
    prior[ids[i]] = {Eigen::Vector3d(x, 0.1, 0), Eigen::Vector3d(x + 0.1, 0.1, 0),
                     Eigen::Vector3d(x + 0.1, 0, 0), Eigen::Vector3d(x, 0, 0)};
  }
  return prior;
}

TEST(MakeFrameDetector, KeepsMarkersOfThePriorShapeThatCanBeDetected) {
  Layout layout = MakeLayout("DICT_4X4_50", 0.1);
  const PriorShape prior = RowOfMarkers({1, 2, 3, 49, 50});
  EXPECT_EQ(MakeFrameDetector(layout, {}, prior).prior_shape.size(), 4u);
  layout.parts.push_back({"board", false, {}, {}, {1, 3}});
  const FrameDetector detector = MakeFrameDetector(layout, {}, prior);
  EXPECT_EQ(detector.prior_shape.size(), 2u);
  EXPECT_EQ(detector.prior_shape.count(2), 0u);
}

TEST(CheckDictionaryOf, OtherDictionariesAndBordersAreRefused) {
  Layout layout = MakeLayout("DICT_4X4_50", 0.1);
  const std::string description = DescribeDetector(MakeFrameDetector(layout, {}));
  const auto check = [&] { CheckDictionaryOf(description, layout, "a.db"); };
  EXPECT_NO_THROW(check());
  layout.dictionary = "4x4_50";
  EXPECT_NO_THROW(check());
  layout.dictionary = "";
  EXPECT_NO_THROW(check());
  layout.dictionary = "DICT_4X4_100";
  ExpectThrows<InputError>(check, {"a.db", "DICT_4X4_100", "DICT_4X4_50 "});
  EXPECT_NO_THROW(CheckDictionaryOf("a chessboard of 9 x 6", layout, "a.db"));
  layout.dictionary = "DICT_4X4_50";
  layout.border_bits = 2;
  ExpectThrows<InputError>(check, {"border_bits=2", "border_bits=1"});
}

TEST(DescribeDetector, NamesThePriorShape) {
  const Layout layout = MakeLayout("DICT_4X4_50", 0.1);
  const auto describe = [&](const PriorShape& prior) {
    return DescribeDetector(MakeFrameDetector(layout, {}, prior));
  };
  const PriorShape prior = RowOfMarkers({1, 2, 3});
  PriorShape moved = prior;
  moved[2][3].z() += 1e-15;
  EXPECT_EQ(describe(prior), describe(RowOfMarkers({1, 2, 3})));
  EXPECT_NE(describe(prior), describe({}));
  EXPECT_NE(describe(prior), describe(moved));
  EXPECT_NE(describe(prior), describe(RowOfMarkers({1, 2, 4})));
}

// A row of markers on a line of the layout, seen straight on with 100 px for 0.1 m; 2 and 5 are not
// found.
TEST(ExpectInFrame, ThePriorShapeIsAskedBeforeTheLines) {
  Layout layout = MakeLayout("DICT_4X4_50", 0.1);
  layout.parts.push_back({"board", false, {{"h1", {0, 1, 2, 3, 4, 5, 6}}}, {}, {}});
  const Camera camera = {CameraModel::kPinhole, 2000, 400, {1000, 1000, 0, 0}};
  const PriorShape row = RowOfMarkers({0, 1, 2, 3, 4, 5, 6});
  std::vector<MarkerQuad> found;
  for (const int id : {0, 1, 3, 4, 6}) {
    const double left_px = 300.0 * id + 99.5;
    found.push_back({id,
                     {Eigen::Vector2d(left_px, 99.5), Eigen::Vector2d(left_px + 100, 99.5),
                      Eigen::Vector2d(left_px + 100, 199.5), Eigen::Vector2d(left_px, 199.5)}});
  }
  const auto expect = [&](SearchMode search, const PriorShape& prior) {
    ArucoDetectionOptions options;
    options.search = search;
    options.min_marker_perimeter_rate = 0.1;
    PriorShapeAgreement agreement;
    return ExpectInFrame(MakeFrameDetector(layout, options, prior), camera, found, &agreement);
  };
  EXPECT_EQ(expect(SearchMode::kTracked, {}).size(), 2u);
  EXPECT_EQ(expect(SearchMode::kExhaustive, {}).size(), 0u);

  PriorShape prior = row;
  prior.erase(5);                                    // stays to the line
  for (Eigen::Vector3d& x : prior[2]) x.y() -= 0.1;  // and 2 is elsewhere than its line says
  for (auto& [id, corners] : prior) {
    for (Eigen::Vector3d& x : corners) x.y() = -x.y();  // y down, as in the picture
  }
  std::vector<ExpectedMarker> all = expect(SearchMode::kTracked, prior);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].quad.marker_id, 2);
  EXPECT_NEAR(QuadCenter(all[0].quad.corners_px).y(), 249.5, 1e-3);
  EXPECT_EQ(all[1].quad.marker_id, 5);
  EXPECT_NEAR(QuadCenter(all[1].quad.corners_px).y(), 149.5, 1e-3);
  EXPECT_EQ(expect(SearchMode::kExhaustive, prior).size(), 1u);

  for (Eigen::Vector3d& x : prior[2]) x = 0.4 * (x - prior[2][0]) + prior[2][0];
  all = expect(SearchMode::kTracked, prior);  // now it is too small for a search to take
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].quad.marker_id, 5);
}

TEST(LocateInFrame, AnIdBeyondTheDictionaryIsNowhere) {
  const FrameDetector detector = MakeFrameDetector(MakeLayout("DICT_4X4_50", 0.1), {});
  const cv::Mat gray(100, 100, CV_8UC1, cv::Scalar(255));
  const QuadCorners quad = {Eigen::Vector2d(30, 30), Eigen::Vector2d(60, 30),
                            Eigen::Vector2d(60, 60), Eigen::Vector2d(30, 60)};
  for (const int marker_id : {-1, 50, 1000}) {
    EXPECT_FALSE(LocateInFrame(detector, gray, marker_id, quad, 5));
  }
}

}  // namespace
}  // namespace velamap
