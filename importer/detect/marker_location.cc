#include "importer/detect/marker_location.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/detect/cell_means.h"
#include "importer/detect/gray_levels.h"
#include "importer/geometry/unit_square_map.h"

namespace velamap {
namespace {

constexpr double kMinCorrelation = 0.8;
constexpr double kSureCorrelation = 0.9;  // the search does not go further out

// The minimum difference of the grey level of a cell from the middle level, as a fraction of the
// contrast.
constexpr double kMinCellContrast = 0.1;

// The pixel at the centre of each cell of the marker, and of one ring of light cells around it.
struct CellPlaces {
  std::vector<cv::Point> pixels;
  std::vector<int> is_light;
  int num_light = 0;
  cv::Rect box;
};

CellPlaces PlacesOfCells(const QuadCorners& quad, const MarkerLook& look) {
  const UnitSquareMap map(quad);
  const int n = look.cells.rows;
  CellPlaces places;
  for (int row = -1; row <= n; ++row) {
    for (int column = -1; column <= n; ++column) {
      const bool is_inside = row >= 0 && column >= 0 && row < n && column < n;
      const Eigen::Vector2d place = map.ToImage((column + 0.5) / n, (row + 0.5) / n);
      places.pixels.emplace_back(static_cast<int>(std::lround(place.x())),
                                 static_cast<int>(std::lround(place.y())));
      const bool is_light = !is_inside || look.cells.at<std::uint8_t>(row, column) != 0;
      places.is_light.push_back(is_light);
      places.num_light += is_light;
    }
  }
  places.box = cv::boundingRect(places.pixels);
  return places;
}

// Correlation between the grey levels at the shifted places and the cells.
double Correlation(const cv::Mat& gray, const CellPlaces& places, const cv::Point& shift,
                   const MarkerLook& look) {
  int sum = 0, light_sum = 0, square_sum = 0;
  for (std::size_t i = 0; i < places.pixels.size(); ++i) {
    const int value = gray.at<std::uint8_t>(places.pixels[i] + shift);
    sum += value;
    square_sum += value * value;
    light_sum += places.is_light[i] * value;
  }
  const double count = static_cast<double>(places.pixels.size());
  const double variance = square_sum - static_cast<double>(sum) * sum / count;
  const double num_light = places.num_light;
  const double light_variance = num_light - num_light * (num_light / count);
  if (variance <= 0 || light_variance <= 0) return 0.0;
  const double covariance = light_sum - sum * (num_light / count);
  return (look.is_inverted ? -1 : 1) * covariance / std::sqrt(variance * light_variance);
}

// Searches the shift of the places with the highest correlation.
class ShiftSearch {
 public:
  ShiftSearch(const cv::Mat& gray, const CellPlaces& places, const MarkerLook& look)
      : gray_(gray), places_(places), look_(look), image_(0, 0, gray.cols, gray.rows) {}

  const cv::Point& best() const { return best_; }
  double best_correlation() const { return best_correlation_; }

  void Try(const cv::Point& shift) {
    const cv::Rect box = places_.box + shift;
    if ((box & image_) != box) return;
    const double correlation = Correlation(gray_, places_, shift, look_);
    if (correlation > best_correlation_) {
      best_correlation_ = correlation;
      best_ = shift;
    }
  }

  // Tries the shifts of a grid around `center` that are `ring` steps away from it.
  void TryRing(const cv::Point& center, int ring, int step) {
    for (int y = -ring; y <= ring; ++y) {
      const int next = std::abs(y) == ring ? 1 : 2 * ring;
      for (int x = -ring; x <= ring; x += std::max(1, next)) {
        Try(center + step * cv::Point(x, y));
      }
    }
  }

 private:
  const cv::Mat& gray_;
  const CellPlaces& places_;
  const MarkerLook& look_;
  cv::Rect image_;
  cv::Point best_;
  double best_correlation_ = 0.0;
};

// Searches from the centre outwards on a grid of half cells, then on finer grids around the best.
std::optional<cv::Point> FindShift(const cv::Mat& gray, const CellPlaces& places,
                                   const MarkerLook& look, double reach_px, double cell_px) {
  ShiftSearch search(gray, places, look);
  int step = std::max(1, static_cast<int>(0.5 * cell_px));
  const int num_rings = static_cast<int>(std::ceil(reach_px / step));
  for (int ring = 0; ring <= num_rings && search.best_correlation() < kSureCorrelation; ++ring) {
    search.TryRing({0, 0}, ring, step);
  }
  for (;; step /= 2) {
    cv::Point center;
    do {
      center = search.best();
      search.TryRing(center, 1, step);
    } while (search.best() != center);
    if (step == 1) break;
  }
  if (search.best_correlation() < kMinCorrelation) return std::nullopt;
  return search.best();
}

// Whether every dark cell is darker than the middle grey level and every light one lighter.
bool ShowsCells(const cv::Mat& gray, const QuadCorners& quad, const MarkerLook& look) {
  const UnitSquareMap map(quad);
  const int n = look.cells.rows;
  std::vector<double> values;
  const CellMeans means = MeansOfCells(look.cells, [&](int column, int row) {
    double value = 0.0;
    for (const double y : {0.3, 0.7}) {
      for (const double x : {0.3, 0.7}) {
        value += 0.25 * GrayAt(gray, map.ToImage((column + x) / n, (row + y) / n), look);
      }
    }
    values.push_back(value);
    return value;
  });
  if (!means.light) return false;
  const double dark = means.dark, light = *means.light;
  if (light - dark < kMinContrast) return false;
  for (int i = 0; i < n * n; ++i) {
    const double relative =
        (values[static_cast<std::size_t>(i)] - 0.5 * (dark + light)) / (light - dark);
    const bool is_light = look.cells.at<std::uint8_t>(i / n, i % n) != 0;
    if ((is_light ? relative : -relative) < kMinCellContrast) return false;
  }
  return true;
}

}  // namespace

std::optional<QuadCorners> LocateMarker(const cv::Mat& gray, const QuadCorners& expected,
                                        const MarkerLook& look, double reach_px) {
  VELAMAP_CHECK(gray.type() == CV_8UC1 && look.cells.type() == CV_8UC1);
  if (!HasCells(expected, look.cells.total())) return std::nullopt;
  const double cell_px = QuadMeanSide(expected) / look.cells.rows;
  const auto shift = FindShift(gray, PlacesOfCells(expected, look), look, reach_px, cell_px);
  if (!shift) return std::nullopt;
  QuadCorners moved = expected;
  for (Eigen::Vector2d& corner : moved) corner += Eigen::Vector2d(shift->x, shift->y);
  const auto aligned = AlignSidesOnce(gray, moved, look);
  if (!aligned || !ShowsCells(gray, *aligned, look)) return std::nullopt;
  return aligned;
}

}  // namespace velamap
