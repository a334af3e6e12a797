#include "importer/detect/marker_search.h"

#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "importer/base/stage_timer.h"
#include "tests/importer/marker_builders.h"
#include "tests/support/render/marker_renderer.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

const std::vector<DrawnMarker> kSearched = {
    {3, 40, 50, 96}, {7, 200, 60, 60}, {11, 320, 41, 24}, {49, 60, 220, 144}};

class SearchMarkersTest : public testing::Test {
 protected:
  SearchMarkersTest() {
    cv::cvtColor(DrawMarkers(dictionary_.aruco, {480, 400}, kSearched), gray_, cv::COLOR_BGR2GRAY);
    cv::GaussianBlur(gray_, gray_, cv::Size(), 0.7);
  }

  std::vector<MarkerQuad> Search(const std::vector<cv::Rect>& regions) const {
    return SearchMarkers(gray_, dictionary_, 1, {}, regions);
  }

  Dictionary dictionary_ = LoadDictionary("DICT_4X4_50");
  cv::Mat gray_;
};

TEST_F(SearchMarkersTest, ARegionGivesTheSameCornersAsTheWhole) {
  const std::vector<MarkerQuad> all = SearchMarkers(gray_, dictionary_, 1, {});
  ASSERT_EQ(all.size(), kSearched.size());
  for (const MarkerQuad& whole : all) {
    const cv::Rect square(static_cast<int>(whole.corners_px[0].x()),
                          static_cast<int>(whole.corners_px[0].y()),
                          static_cast<int>(QuadMeanSide(whole.corners_px)) + 1,
                          static_cast<int>(QuadMeanSide(whole.corners_px)) + 1);
    // Down to 4 px, less than what the threshold sees around a corner.
    for (int reach_px = 4; reach_px < 20; ++reach_px) {
      const std::vector<MarkerQuad> found =
          Search({cv::Rect(square.x - reach_px, square.y - reach_px, square.width + 2 * reach_px,
                           square.height + 2 * reach_px)});
      ASSERT_EQ(found.size(), 1u) << whole.marker_id << " " << reach_px;
      EXPECT_EQ(found[0].marker_id, whole.marker_id);
      EXPECT_EQ(found[0].corners_px, whole.corners_px) << whole.marker_id << " " << reach_px;
    }
  }
}

TEST_F(SearchMarkersTest, OnlyRegionsAreSearchedAndWhatTheyShareComesOnce) {
  EXPECT_TRUE(Search({}).empty());
  EXPECT_TRUE(Search({{0, 0, 100, 400}}).empty());  // cuts through every marker that it touches
  const std::vector<MarkerQuad> found = Search({{20, 30, 160, 150}, {25, 20, 300, 170}});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].marker_id, 3);
  EXPECT_EQ(found[1].marker_id, 7);
}

TEST_F(SearchMarkersTest, TheSmallestPerimeterIsThatOfTheWholeImage) {
  ArucoDetectionOptions options;
  options.min_marker_perimeter_rate = 0.25;  // 120 px: the 24 px marker is too small
  EXPECT_EQ(SearchMarkers(gray_, dictionary_, 1, options).size(), 3u);
  EXPECT_TRUE(SearchMarkers(gray_, dictionary_, 1, options, {{300, 21, 64, 64}}).empty());
  EXPECT_EQ(SearchMarkers(gray_, dictionary_, 1, {}, {{300, 21, 64, 64}}).size(), 1u);
}

// A marker 1 m away whose side takes `side_px` in kTurnedCamera, turned in its plane and slanted.
constexpr double kFocalLengthPx = 200.0;
const Camera kTurnedCamera{
    CameraModel::kPinhole, 120, 120, {kFocalLengthPx, kFocalLengthPx, 60, 60}};

PlacedMarkerInCam TurnedAndSlanted(int marker_id, double side_px, double turn_rad,
                                   double slant_rad) {
  const double half_m = 0.5 * side_px / kFocalLengthPx;
  const Eigen::Matrix3d cam_from_marker = (Eigen::AngleAxisd(slant_rad, Eigen::Vector3d::UnitY()) *
                                           Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()))
                                              .toRotationMatrix();
  const auto at = [&](double x, double y) {
    return Eigen::Vector3d(cam_from_marker * Eigen::Vector3d(x * half_m, y * half_m, 0) +
                           Eigen::Vector3d::UnitZ());
  };
  return {marker_id, {at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)}};
}

// The largest distance of a corner from its true place, px.
double MaxCornerErrorPx(const MarkerQuad& found, const PlacedMarkerInCam& marker) {
  QuadCorners true_px;
  for (int c = 0; c < kNumCorners; ++c) {
    true_px[c] =
        kFocalLengthPx * marker.corners_in_cam[c].hnormalized() + Eigen::Vector2d(59.5, 59.5);
  }
  return MaxCornerShift(found.corners_px, true_px);
}

// As in a small picture of few colours, whose dots imitate the others.
TEST(SearchMarkers, DotsTooSmallForACodeTakeNoTime) {
  cv::Mat gray(270, 480, CV_8UC1, cv::Scalar(200));
  for (int y = 4; y < 264; y += 5) {
    for (int x = 4; x < 474; x += 5) gray(cv::Rect(x, y, 2, 2)).setTo(60);
  }
  constexpr int kNumSearches = 3;
  constexpr double kMaxCpu_s = 2.0;  // without the bound of the contour, each takes as long
  const Dictionary dictionary = LoadDictionary("DICT_4X4_50");
  const double begin_s = ProcessCpuSeconds();
  for (int i = 0; i < kNumSearches; ++i) {
    EXPECT_TRUE(SearchMarkers(gray, dictionary, 1, {}).empty());
  }
  EXPECT_LT(ProcessCpuSeconds() - begin_s, kMaxCpu_s);
}

// OpenCV keeps the largest of close outlines before it reads the codes, which is that of the paper.
TEST(SearchMarkers, TheEdgeOfNarrowPaperOnADarkGroundHidesNoMarker) {
  std::mt19937 random(TestSeed());
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const Dictionary dictionary = LoadDictionary("DICT_4X4_50");
  constexpr int kNumDraws = 200, kNumCells = 6;
  int num_found = 0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    RenderOptions options;
    options.seed = static_cast<std::uint32_t>(draw);
    options.background = between(60, 130);
    options.blur_sigma_px = between(0.4, 1.1);
    options.noise_sigma = between(0, 3);
    const double side_px = between(28, 60);
    options.quiet_zone_cells = kNumCells * std::max(between(0.05, 0.12), 2.0 / side_px);
    const PlacedMarkerInCam marker =
        TurnedAndSlanted(draw % 50, side_px, between(0, 2 * CV_PI), between(0, 40) * kRadPerDeg);
    const std::vector<MarkerQuad> found = SearchMarkers(
        RenderMarkers(kTurnedCamera, {marker}, dictionary, 1, options), dictionary, 1, {});
    if (found.empty()) continue;
    ++num_found;
    ASSERT_EQ(found.size(), 1u) << draw;
    EXPECT_EQ(found[0].marker_id, marker.marker_id) << draw;
    // The paper's corner is 3 px and more away.
    EXPECT_LT(MaxCornerErrorPx(found[0], marker), 2.3) << draw;
  }
  EXPECT_GE(num_found, 0.97 * kNumDraws);
}

// Cells of 3.6 to 5 px, blurred by up to a quarter of a cell: an outline that is a pixel off spoils
// the rim of each.
TEST(SearchMarkers, CodesOfSmallCellsAreRead) {
  std::mt19937 random(TestSeed());
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const Dictionary dictionary = LoadDictionary("DICT_5X5_250");
  constexpr int kNumDraws = 200, kNumCells = 7;
  int num_found = 0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    RenderOptions options;
    options.seed = static_cast<std::uint32_t>(draw);
    options.background = 200;
    options.blur_sigma_px = between(0.7, 1.0);
    options.noise_sigma = between(0, 3);
    const PlacedMarkerInCam marker = TurnedAndSlanted(
        draw, kNumCells * between(3.6, 5.0), between(0, 2 * CV_PI), between(0, 40) * kRadPerDeg);
    const std::vector<MarkerQuad> found = SearchMarkers(
        RenderMarkers(kTurnedCamera, {marker}, dictionary, 1, options), dictionary, 1, {});
    num_found += found.size() == 1 && found[0].marker_id == draw;
  }
  EXPECT_GE(num_found, 0.9 * kNumDraws);
}

// Cells of 1.9 to 2.6 px, blurred by a third of a cell and more, which often only a second look
// reads.
class BlurredSmallMarkers : public testing::Test {
 protected:
  PlacedMarkerInCam Draw(int marker_id) {
    return TurnedAndSlanted(marker_id, kNumCells * Between(1.9, 2.6), Between(0, 2 * CV_PI),
                            Between(0, 30) * kRadPerDeg);
  }
  cv::Mat Render(const PlacedMarkerInCam& marker) {
    RenderOptions options;
    options.seed = static_cast<std::uint32_t>(marker.marker_id);
    options.background = Between(50, 120);
    options.quiet_zone_cells = Between(0.6, 1.0);
    options.blur_sigma_px = Between(0.8, 1.0);
    options.noise_sigma = Between(0, 2);
    return RenderMarkers(kTurnedCamera, {marker}, dictionary_, 1, options);
  }
  double Between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  static constexpr int kNumCells = 6;
  Dictionary dictionary_ = LoadDictionary("DICT_4X4_250");
  std::mt19937 random_{TestSeed()};
};

TEST_F(BlurredSmallMarkers, AreFoundByASecondLook) {
  constexpr int kNumDraws = 200;
  int num_found = 0, num_misread = 0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    const PlacedMarkerInCam marker = Draw(draw);
    const std::vector<MarkerQuad> found = SearchMarkers(Render(marker), dictionary_, 1, {});
    if (found.empty()) continue;
    ++num_found;
    ASSERT_EQ(found.size(), 1u) << draw;
    EXPECT_LT(MaxCornerErrorPx(found[0], marker), 3.0) << draw;
    if (found[0].marker_id == draw) continue;
    EXPECT_FALSE(found[0].is_second_look) << draw;
    ++num_misread;
  }
  EXPECT_GE(num_found, 0.85 * kNumDraws);
  EXPECT_LE(num_misread, 1);  // the first look misreads one of 700
}

// As a letter may look like a marker, once it is enlarged.
TEST_F(BlurredSmallMarkers, TakeNoIdFromAMarkerThatIsReadAtOnce) {
  int num_second_looks = 0;
  for (int draw = 0; draw < 20; ++draw) {
    const cv::Mat small = Render(Draw(draw));
    const std::vector<MarkerQuad> alone = SearchMarkers(small, dictionary_, 1, {});
    num_second_looks += !alone.empty() && alone[0].is_second_look;
    RenderOptions sharp;
    sharp.background = 200;
    const cv::Mat large =
        RenderMarkers(kTurnedCamera, {TurnedAndSlanted(draw, 50, 0.3, 0)}, dictionary_, 1, sharp);
    cv::Mat both;
    cv::hconcat(small, large, both);
    const std::vector<MarkerQuad> found = SearchMarkers(both, dictionary_, 1, {});
    if (!alone.empty() && !alone[0].is_second_look) continue;
    ASSERT_EQ(found.size(), 1u) << draw;
    EXPECT_GT(QuadMeanSide(found[0].corners_px), 40) << draw;
  }
  EXPECT_GT(num_second_looks, 5);
}

}  // namespace
}  // namespace velamap
