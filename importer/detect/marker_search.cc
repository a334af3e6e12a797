#include "importer/detect/marker_search.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/detect/interpolate.h"
#include "importer/detect/search_regions.h"
#include "importer/detect/second_look.h"

namespace velamap {
namespace {

constexpr int kMinBorderDistancePx = 3;  // of a corner
// Smaller cells than a pixel show no code, so a marker of n cells has a contour of 4 n pixels,
// or 2.8 n where it is turned by 45 degrees. Without this bound, each dot of a small dithered
// picture is an outline to decode.
constexpr double kLeastContourPxPerCell = 2.5;
// Reach of a second look around an outline: two pixels, because the outline may lie that far inside
// its marker, plus the reach of the first look in pixels of the enlarged picture.
constexpr int kSecondReachPx = 2 + (kSearchReachPx + kEnlargement - 1) / kEnlargement;

// For a region of an image; the smallest perimeter is relative to the size of the image, but at
// least `least_contour_px`.
cv::Ptr<cv::aruco::DetectorParameters> MakeParameters(int border_bits,
                                                      const ArucoDetectionOptions& options,
                                                      double least_contour_px, int image_size_px,
                                                      int region_size_px) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  // Windows of 5 and 13 px find as many markers as OpenCV's 3, 13 and 23 px, and more small ones
  // among other black squares, in three quarters of the time (measured on photographs of markers of
  // 34 to 110 px and at 4K on 12 to 500 px, sharp and blurred).
  parameters->adaptiveThreshWinSizeMin = 5;
  parameters->adaptiveThreshWinSizeMax = 13;
  parameters->adaptiveThreshWinSizeStep = 8;
  // Every outline is decoded. OpenCV keeps the largest of close outlines before it reads their
  // codes: where a narrow margin lies on a dark ground, that is the edge of the paper, which gives
  // no code.
  parameters->minMarkerDistanceRate = 0.0;
  // Reads only the middle of each cell, because blur and an outline that is a pixel off spoil its
  // rim. This finds twice as many markers with cells of 4 px (measured on rendered photographs).
  parameters->perspectiveRemoveIgnoredMarginPerCell = 0.3;
  parameters->minDistanceToBorder = kMinBorderDistancePx;
  parameters->markerBorderBits = border_bits;
  parameters->errorCorrectionRate = options.error_correction_rate;
  // OpenCV truncates the product of rate and region size to whole pixels. Half a pixel more makes
  // the result perimeter_px, the same as for the whole image.
  const double perimeter_px = std::max(
      std::floor(options.min_marker_perimeter_rate * image_size_px), std::floor(least_contour_px));
  parameters->minMarkerPerimeterRate = (perimeter_px + 0.5) / region_size_px;
  return parameters;
}

cv::Rect Grown(const cv::Rect& rect, int by_px) {
  const cv::Point by(by_px, by_px);
  return {rect.tl() - by, rect.br() + by};
}

bool Contains(const cv::Rect& outer, const cv::Rect& inner) { return (outer & inner) == inner; }

// Whether the image is darker inside the outline than outside, as it is for a marker. The edge of
// the marker's paper on a darker ground may give the same code, but is lighter inside.
bool IsDarkInside(const cv::Mat& gray, const std::vector<cv::Point2f>& outline_px) {
  constexpr int kNumSamples = 8;  // of a side
  constexpr float kOffsetPx = 1.5F;
  const cv::Point2f center = (outline_px[0] + outline_px[1] + outline_px[2] + outline_px[3]) / 4;
  int outside_minus_inside = 0;
  for (int c = 0; c < kNumCorners; ++c) {
    const cv::Point2f side = outline_px[(c + 1) % kNumCorners] - outline_px[c];
    for (int i = 0; i < kNumSamples; ++i) {
      const cv::Point2f on_side = outline_px[c] + (i + 0.5F) / kNumSamples * side;
      const cv::Point2f inwards = center - on_side;
      const cv::Point2f step = inwards * (kOffsetPx / std::max(1.0, cv::norm(inwards)));
      outside_minus_inside += NearestGray(gray, on_side - step) - NearestGray(gray, on_side + step);
    }
  }
  return outside_minus_inside > 0;
}

// What cv::aruco finds in a picture of dark markers on light paper.
struct Found {
  std::vector<int> ids;
  std::vector<Outline> read, rejected;
};

Found Detect(const cv::Mat& dark_on_light, const Dictionary& dictionary,
             const cv::Ptr<cv::aruco::DetectorParameters>& parameters) {
  Found found;
  cv::aruco::detectMarkers(dark_on_light, dictionary.aruco, found.read, found.ids, parameters,
                           found.rejected);
  return found;
}

// An image with dark markers on light paper, and what to search in it.
struct Search {
  cv::Mat dark_on_light;
  const Dictionary& dictionary;
  int border_bits;
  const ArucoDetectionOptions& options;

  cv::Rect Image() const { return {{}, dark_on_light.size()}; }
  int ImageSizePx() const { return std::max(dark_on_light.cols, dark_on_light.rows); }
  double LeastContourPx() const {
    return kLeastContourPxPerCell * CellsPerSide(dictionary, border_bits);
  }
};

void AddQuads(const Search& search, const Found& found, bool is_second_look,
              std::vector<MarkerQuad>* quads) {
  for (std::size_t i = 0; i < found.ids.size(); ++i) {
    if (!IsDarkInside(search.dark_on_light, found.read[i])) continue;
    MarkerQuad quad;
    quad.marker_id = found.ids[i];
    quad.is_second_look = is_second_look;
    for (int c = 0; c < kNumCorners; ++c)
      quad.corners_px[c] = {found.read[i][c].x, found.read[i][c].y};
    quads->push_back(quad);
  }
}

// Searches around an outline whose code could not be read.
void LookAgain(const Search& search, const cv::Rect& part, std::vector<MarkerQuad>* quads) {
  const auto parameters = MakeParameters(
      search.border_bits, search.options, kEnlargement * search.LeastContourPx(),
      kEnlargement * search.ImageSizePx(), kEnlargement * std::max(part.width, part.height));
  parameters->minDistanceToBorder = kEnlargement * kMinBorderDistancePx;
  Found found =
      Detect(EnlargedAndSharpened(search.dark_on_light(part)), search.dictionary, parameters);
  for (Outline& outline_px : found.read) {
    for (cv::Point2f& corner : outline_px) {
      corner = InOriginal(corner) + cv::Point2f(part.tl());
    }
  }
  AddQuads(search, found, true, quads);
}

// Drops second looks at ids that were read at the first look, because small letters and ornaments
// may look like markers once they are enlarged.
void RemoveSecondLooksOfRead(std::vector<MarkerQuad>* quads) {
  std::set<int> read;
  for (const MarkerQuad& quad : *quads) {
    if (!quad.is_second_look) read.insert(quad.marker_id);
  }
  quads->erase(std::remove_if(quads->begin(), quads->end(),
                              [&](const MarkerQuad& quad) {
                                return quad.is_second_look && read.count(quad.marker_id) > 0;
                              }),
               quads->end());
}

void SearchRegion(const Search& search, const cv::Rect& region, bool looks_again,
                  std::vector<MarkerQuad>* quads) {
  Found found = Detect(search.dark_on_light(region), search.dictionary,
                       MakeParameters(search.border_bits, search.options, search.LeastContourPx(),
                                      search.ImageSizePx(), std::max(region.width, region.height)));
  for (std::vector<Outline>* outlines : {&found.read, &found.rejected}) {
    for (Outline& outline_px : *outlines) {
      for (cv::Point2f& corner : outline_px) corner += cv::Point2f(region.tl());
    }
  }
  AddQuads(search, found, false, quads);
  if (!looks_again) return;
  const int num_cells = CellsPerSide(search.dictionary, search.border_bits);
  for (const Outline& outline_px : UnreadOutlines(found.read, found.rejected, num_cells)) {
    const cv::Rect around = cv::boundingRect(outline_px);
    // An outline near the border of the region is left to another region.
    if (Contains(region, Grown(around, kSearchReachPx) & search.Image())) {
      LookAgain(search, Grown(around, kSecondReachPx) & search.Image(), quads);
    }
  }
}

// Searches the regions. If a region cuts off pixels on which a marker depends, searches around
// the marker again.
std::vector<MarkerQuad> SearchRegions(const Search& search, const std::vector<cv::Rect>& regions,
                                      bool looks_again) {
  std::vector<MarkerQuad> quads;
  for (const cv::Rect& region : regions) {
    std::vector<MarkerQuad> found;
    SearchRegion(search, region, looks_again, &found);
    for (const MarkerQuad& quad : found) {
      const auto around = [&](int reach_px) {
        return PixelsAround(BoundingBox(quad.corners_px), search.Image().size(), reach_px);
      };
      if (Contains(region, around(kSearchReachPx))) {
        quads.push_back(quad);
      } else {
        SearchRegion(search, around(2 * kSearchReachPx), looks_again, &quads);
      }
    }
  }
  RemoveSecondLooksOfRead(&quads);
  return RemoveNested(std::move(quads));
}

Search MakeSearch(const cv::Mat& gray, const Dictionary& dictionary, int border_bits,
                  const ArucoDetectionOptions& options) {
  VELAMAP_CHECK(gray.type() == CV_8UC1);
  return {options.inverted ? cv::Mat(~gray) : gray, dictionary, border_bits, options};
}

}  // namespace

bool IsLargeEnough(const QuadCorners& corners, const cv::Size& image_size,
                   const ArucoDetectionOptions& options) {
  return kNumCorners * QuadMeanSide(corners) >
         options.min_marker_perimeter_rate * std::max(image_size.width, image_size.height);
}

bool IsSearchable(const QuadCorners& corners, const cv::Size& image_size,
                  const ArucoDetectionOptions& options) {
  const double min = kMinBorderDistancePx;
  const double max_x = image_size.width - 1 - min, max_y = image_size.height - 1 - min;
  return IsLargeEnough(corners, image_size, options) &&
         std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
           return corner.x() > min && corner.y() > min && corner.x() < max_x && corner.y() < max_y;
         });
}

std::vector<MarkerQuad> RemoveNested(std::vector<MarkerQuad> quads) {
  std::stable_sort(quads.begin(), quads.end(), [](const MarkerQuad& a, const MarkerQuad& b) {
    return QuadArea(a.corners_px) > QuadArea(b.corners_px);
  });
  std::vector<MarkerQuad> kept;
  for (const MarkerQuad& quad : quads) {
    const bool nested = std::any_of(kept.begin(), kept.end(), [&](const MarkerQuad& outer) {
      const double distance = (QuadCenter(outer.corners_px) - QuadCenter(quad.corners_px)).norm();
      return outer.marker_id == quad.marker_id && distance < 0.5 * QuadMeanSide(outer.corners_px);
    });
    if (!nested) kept.push_back(quad);
  }
  return kept;
}

std::vector<MarkerQuad> SearchMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                      int border_bits, const ArucoDetectionOptions& options) {
  return SearchMarkers(gray, dictionary, border_bits, options, {{0, 0, gray.cols, gray.rows}});
}

std::vector<MarkerQuad> SearchMarkersAtFirstLook(const cv::Mat& gray, const Dictionary& dictionary,
                                                 int border_bits,
                                                 const ArucoDetectionOptions& options) {
  const Search search = MakeSearch(gray, dictionary, border_bits, options);
  return SearchRegions(search, {search.Image()}, false);
}

std::vector<MarkerQuad> SearchMarkersCoarsely(const cv::Mat& gray, const Dictionary& dictionary,
                                              int border_bits,
                                              const ArucoDetectionOptions& options) {
  cv::Mat half;
  cv::resize(gray, half, {}, 0.5, 0.5, cv::INTER_AREA);
  const Search search = MakeSearch(half, dictionary, border_bits, options);
  std::vector<MarkerQuad> quads = SearchRegions(search, {search.Image()}, false);
  for (MarkerQuad& quad : quads) {
    for (Eigen::Vector2d& corner : quad.corners_px) {
      corner = 2.0 * corner + Eigen::Vector2d(0.5, 0.5);  // of pixel centres
    }
  }
  return quads;
}

std::vector<MarkerQuad> SearchMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                      int border_bits, const ArucoDetectionOptions& options,
                                      const std::vector<cv::Rect>& regions) {
  return SearchRegions(MakeSearch(gray, dictionary, border_bits, options), regions, true);
}

}  // namespace velamap
