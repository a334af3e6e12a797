#include "importer/refine/marker_detector.h"

#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>

#include "importer/dictionary_hint.h"
#include "tests/importer/marker_builders.h"
#include "tests/support/detect_markers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

cv::Mat Gray(const cv::Mat& color) {
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  // A lens never draws a step sharper than this.
  cv::GaussianBlur(gray, gray, cv::Size(), 0.7);
  return gray;
}

double MaxCornerError(const MarkerDetection& marker, const DrawnMarker& drawn) {
  const Eigen::Vector2d top_left(drawn.left, drawn.top);
  const double s = drawn.side;
  return MaxCornerShift(marker.corners_in_image_px,
                        {top_left, top_left + Eigen::Vector2d(s, 0),
                         top_left + Eigen::Vector2d(s, s), top_left + Eigen::Vector2d(0, s)});
}

std::vector<MarkerDetection> Sorted(std::vector<MarkerDetection> markers) {
  std::sort(markers.begin(), markers.end(),
            [](const auto& a, const auto& b) { return a.marker_id < b.marker_id; });
  return markers;
}

const std::vector<DrawnMarker> kDrawn = {
    {3, 40, 50, 96}, {7, 200, 60, 60}, {11, 320, 41, 24}, {49, 60, 220, 144}};

TEST(DetectMarkers, CornersOfDrawnMarkersAreExact) {
  const Dictionary dictionary = LoadDictionary("DICT_4X4_50");
  const cv::Mat gray = Gray(DrawMarkers(dictionary.aruco, {480, 400}, kDrawn));
  for (const bool inverted : {false, true}) {
    ArucoDetectionOptions options;
    options.inverted = inverted;
    const std::vector<MarkerDetection> markers =
        Sorted(DetectMarkers(inverted ? cv::Mat(255 - gray) : gray, dictionary, 1, options));
    ASSERT_EQ(markers.size(), kDrawn.size());
    for (std::size_t i = 0; i < markers.size(); ++i) {
      EXPECT_EQ(markers[i].marker_id, kDrawn[i].marker_id);
      EXPECT_LT(MaxCornerError(markers[i], kDrawn[i]), 0.1) << kDrawn[i].side << " px";
    }
    options.inverted = !inverted;
    EXPECT_TRUE(
        DetectMarkers(inverted ? cv::Mat(255 - gray) : gray, dictionary, 1, options).empty());
  }
}

TEST(DetectMarkers, SubpixIsNearAndNoneIsWithinAPixelAndAHalf) {
  const Dictionary dictionary = LoadDictionary("DICT_4X4_50");
  const cv::Mat gray = Gray(DrawMarkers(dictionary.aruco, {480, 400}, kDrawn));
  for (const auto& [refinement, limit_px] :
       {std::make_pair(CornerRefinement::kSubpix, 0.75), {CornerRefinement::kNone, 1.5}}) {
    ArucoDetectionOptions options;
    options.corner_refinement = refinement;
    const std::vector<MarkerDetection> markers =
        Sorted(DetectMarkers(gray, dictionary, 1, options));
    ASSERT_EQ(markers.size(), kDrawn.size());
    for (std::size_t i = 0; i < markers.size(); ++i) {
      EXPECT_LT(MaxCornerError(markers[i], kDrawn[i]), limit_px)
          << CornerRefinementName(refinement) << " " << kDrawn[i].side << " px";
    }
  }
}

TEST(DetectMarkers, ThreeByThreeDictionaryWithWideBorderInEveryRotation) {
  const TempDir dir;
  const std::string path = dir / "d.yml";
  std::ofstream(path) << "%YAML:1.0\n---\nnmarkers: 2\nmarkersize: 3\nmaxCorrectionBits: 0\n"
                         "marker_0: \"110100001\"\nmarker_1: \"111000100\"\n";
  const Dictionary dictionary = LoadDictionary(path);
  const DrawnMarker drawn{1, 60, 60, 98};
  cv::Mat gray = Gray(DrawMarkers(dictionary.aruco, {218, 218}, {drawn}, 2));
  for (int turns = 0; turns < 4; ++turns) {
    const std::vector<MarkerDetection> markers = DetectMarkers(gray, dictionary, 2, {});
    ASSERT_EQ(markers.size(), 1u);
    EXPECT_EQ(markers[0].marker_id, 1);
    // The picture is square and the marker in its middle: corner 1 moves on with every turn.
    MarkerDetection upright = markers[0];
    std::rotate(upright.corners_in_image_px.begin(),
                upright.corners_in_image_px.begin() + (4 - turns) % 4,
                upright.corners_in_image_px.end());
    EXPECT_LT(MaxCornerError(upright, drawn), 0.1);
    cv::rotate(gray, gray, cv::ROTATE_90_CLOCKWISE);
  }
}

TEST(DetectMarkers, DuplicatedIdsAreAllHandedOut) {
  const Dictionary dictionary = LoadDictionary("DICT_4X4_50");
  const cv::Mat gray =
      Gray(DrawMarkers(dictionary.aruco, {480, 200}, {{3, 40, 50, 96}, {3, 300, 50, 96}}));
  EXPECT_EQ(DetectMarkers(gray, dictionary, 1, {}).size(), 2u);
}

// The search may find several outlines of one marker, and take some of them for another marker.
TEST(RefineMarkers, TwoReadingsOfOnePlaceAreOneMarker) {
  const Dictionary dictionary = LoadDictionary("DICT_4X4_50");
  const cv::Mat gray = Gray(DrawMarkers(dictionary.aruco, {480, 400}, kDrawn));
  const std::vector<MarkerQuad> found = SearchMarkers(gray, dictionary, 1, {});
  ASSERT_EQ(found.size(), kDrawn.size());
  for (const int wrong_id : {0, 20, 37}) {
    std::vector<MarkerQuad> quads;
    for (const MarkerQuad& quad : found) {
      MarkerQuad wrong = quad;
      wrong.marker_id = wrong_id;
      for (Eigen::Vector2d& corner : wrong.corners_px) corner.x() += 0.5;
      quads.insert(quads.end(), {wrong, quad});
    }
    for (const bool wrong_first : {true, false}) {
      if (!wrong_first) std::reverse(quads.begin(), quads.end());
      const auto markers = Sorted(RefineMarkers(gray, quads, dictionary, 1, {}));
      ASSERT_EQ(markers.size(), kDrawn.size());
      for (std::size_t i = 0; i < markers.size(); ++i) {
        EXPECT_EQ(markers[i].marker_id, kDrawn[i].marker_id);
        EXPECT_LT(MaxCornerError(markers[i], kDrawn[i]), 0.1);
      }
    }
  }
}

TEST(SuggestDictionaries, NamesTheSmallestDictionaryAndThePolarity) {
  const Dictionary dictionary = LoadDictionary("DICT_5X5_100");
  const cv::Mat gray = Gray(DrawMarkers(dictionary.aruco, {480, 200},
                                        {{3, 40, 50, 84}, {72, 180, 50, 84}, {9, 320, 50, 84}}));
  for (const bool inverted : {false, true}) {
    const std::vector<DictionaryHint> hints =
        SuggestDictionaries({inverted ? cv::Mat(255 - gray) : gray}, 1, {});
    ASSERT_EQ(hints.size(), 1u) << DescribeHints(hints);
    EXPECT_EQ(hints[0].dictionary, "DICT_5X5_100");
    EXPECT_EQ(hints[0].inverted, inverted);
    EXPECT_EQ(hints[0].num_markers, 3);
  }
  EXPECT_TRUE(SuggestDictionaries({cv::Mat(200, 200, CV_8UC1, cv::Scalar(9))}, 1, {}).empty());
}

TEST(SuggestDictionaries, CodesOfFewBitsAreNoEvidenceOnTheirOwn) {
  const Dictionary dictionary = LoadDictionary("DICT_4X4_1000");
  const cv::Mat gray = Gray(DrawMarkers(
      dictionary.aruco, {480, 200}, {{317, 40, 50, 84}, {940, 180, 50, 84}, {611, 320, 50, 84}}));
  EXPECT_TRUE(SuggestDictionaries({gray}, 1, {}).empty());
  const std::vector<DictionaryHint> hints = SuggestDictionaries({gray, gray}, 1, {});
  ASSERT_EQ(hints.size(), 1u);
  EXPECT_EQ(hints[0].dictionary, "DICT_4X4_1000");
}

TEST(SuggestDictionaries, AFalseIdDoesNotAskForALargerDictionary) {
  const Dictionary dictionary = LoadDictionary("DICT_4X4_1000");
  std::vector<DrawnMarker> drawn = {{940, 40, 440, 60}};
  for (int i = 0; i < 24; ++i) {
    drawn.push_back({100 + i, 40 + 120 * (i % 8), 50 + 130 * (i / 8), 60});
  }
  const cv::Mat gray = Gray(DrawMarkers(dictionary.aruco, {1040, 560}, drawn));
  const std::vector<DictionaryHint> hints = SuggestDictionaries({gray}, 1, {});
  ASSERT_EQ(hints.size(), 1u) << DescribeHints(hints);
  EXPECT_EQ(hints[0].dictionary, "DICT_4X4_250");
  EXPECT_EQ(hints[0].num_markers, 24);
  EXPECT_THAT(DescribeHints(hints), testing::HasSubstr("change its key `dictionary`"));
}

// The first picture convinces, but shows the lower half of the object only.
TEST(SuggestDictionaries, TheIdsOfAllPicturesTellTheSizeOfTheDictionary) {
  const Dictionary dictionary = LoadDictionary("DICT_4X4_1000");
  std::vector<cv::Mat> images;
  for (const int first_id : {0, 80}) {
    std::vector<DrawnMarker> drawn;
    for (int i = 0; i < 24; ++i) {
      drawn.push_back({first_id + i, 40 + 120 * (i % 8), 50 + 130 * (i / 8), 60});
    }
    images.push_back(Gray(DrawMarkers(dictionary.aruco, {1040, 460}, drawn)));
  }
  const std::vector<DictionaryHint> hints = SuggestDictionaries(images, 1, {});
  ASSERT_EQ(hints.size(), 1u) << DescribeHints(hints);
  EXPECT_EQ(hints[0].dictionary, "DICT_4X4_250");
  EXPECT_EQ(hints[0].num_markers, 24);  // as many pictures as were searched for other families
  EXPECT_EQ(hints[0].num_images, 1);
}

TEST(DictionaryFamily, BeginsWithTheSameMarkers) {
  EXPECT_EQ(LargestOfFamily("DICT_5X5_50"), "DICT_5X5_1000");
  EXPECT_EQ(LargestOfFamily("DICT_APRILTAG_36h11"), "DICT_APRILTAG_36h11");
  EXPECT_EQ(SmallestOfFamily("DICT_5X5_1000", 49), "DICT_5X5_50");
  EXPECT_EQ(SmallestOfFamily("DICT_5X5_50", 250), "DICT_5X5_1000");
  EXPECT_EQ(SmallestOfFamily("DICT_ARUCO_ORIGINAL", 700), "DICT_ARUCO_ORIGINAL");
}

TEST(SuggestDictionaries, TwoMarkersInTwelvePicturesAreNoEvidence) {
  const Dictionary dictionary = LoadDictionary("DICT_6X6_100");
  const cv::Mat shown =
      Gray(DrawMarkers(dictionary.aruco, {480, 200}, {{3, 40, 50, 84}, {72, 180, 50, 84}}));
  std::vector<cv::Mat> images(12, cv::Mat(200, 480, CV_8UC1, cv::Scalar(255)));
  images[5] = shown;
  EXPECT_TRUE(SuggestDictionaries(images, 1, {}).empty());
  EXPECT_EQ(SuggestDictionaries({shown}, 1, {}).size(), 1u);
}

TEST(ImageSample, SpreadsOverAStreamOfAnyLength) {
  for (const int num_images : {1, 12, 13, 57, 1000}) {
    ImageSample sample;
    for (int i = 0; i < num_images; ++i) sample.Add(i, cv::Mat(1, 1, CV_32SC1, cv::Scalar(i)));
    const std::vector<cv::Mat> images = sample.Images();
    EXPECT_GE(images.size(), std::min(6u, static_cast<unsigned>(num_images)));
    EXPECT_LE(images.size(), 12u);
    EXPECT_EQ(images.front().at<int>(0), 0);
    EXPECT_GE(images.back().at<int>(0), num_images / 2);
  }
}

}  // namespace
}  // namespace velamap
