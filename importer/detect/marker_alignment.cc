#include "importer/detect/marker_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "importer/base/error.h"
#include "importer/detect/interpolate.h"
#include "importer/geometry/unit_square_map.h"

namespace velamap {
namespace {

constexpr double kMinContrast = 12.0;  // grey levels

// Scans across a side: where along it, of its length, and how many have to see the edge.
constexpr int kNumScans = 9;
constexpr int kMinScans = 6;
constexpr double kFirstScan = 0.14;
constexpr double kHalfScanCells = 0.5;
constexpr int kMaxScanSteps = 40;

// How far a scan may see the edge from the line through the others.
constexpr double kMaxDeparturePx = 0.7;
constexpr double kMaxDepartureCells = 0.12;

// A quad that moves less stands where its sides are, wherever it came from.
constexpr double kSettledPx = 0.01;
constexpr int kMaxLooks = 6;

constexpr double kMinCorrelation = 0.8;
constexpr double kSureCorrelation = 0.9;  // no other place does better than near this one

// How far from the middle grey level a cell's has to be, in parts of the contrast.
constexpr double kMinCellContrast = 0.1;

double GrayAt(const cv::Mat& gray, const Eigen::Vector2d& x_px, const MarkerLook& look) {
  const double value = InterpolateGray(gray, x_px);
  return look.is_inverted ? 255.0 - value : value;
}

// From the frame of a side, with `along` on it and `inwards` from it, to the marker's.
Eigen::Vector2d FromSide(int side, double along, double inwards) {
  switch (side) {
    case 0:
      return {along, inwards};
    case 1:
      return {1 - inwards, along};
    case 2:
      return {1 - along, 1 - inwards};
    default:
      return {inwards, 1 - along};
  }
}

// Where the grey level is halfway on the way from `inner` to `outer`.
std::optional<Eigen::Vector2d> FindStep(const cv::Mat& gray, const Eigen::Vector2d& inner_px,
                                        const Eigen::Vector2d& outer_px, const MarkerLook& look) {
  const Eigen::Vector2d way = outer_px - inner_px;
  const int num_steps = std::clamp(static_cast<int>(std::ceil(way.norm() / 0.7)), 3, kMaxScanSteps);
  const double dark = GrayAt(gray, inner_px, look), light = GrayAt(gray, outer_px, look);
  if (light - dark < kMinContrast) return std::nullopt;
  const double middle = 0.5 * (dark + light);
  double value = dark;
  for (int i = 0; i < num_steps; ++i) {
    const double next =
        GrayAt(gray, inner_px + way * (static_cast<double>(i + 1) / num_steps), look);
    if (next > middle) {
      return inner_px + way * ((i + (middle - value) / (next - value)) / num_steps);
    }
    value = next;
  }
  return std::nullopt;
}

// Least squares; without those that depart by more than `max_departure_px`, of which there may be
// some.
std::optional<ImageLine> FitLine(std::vector<Eigen::Vector2d> points_px,
                                 const Eigen::Vector2d& along, double max_departure_px) {
  const Eigen::Vector2d across(-along.y(), along.x());
  while (points_px.size() >= kMinScans) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& point : points_px) mean += point;
    mean /= static_cast<double>(points_px.size());
    double variance = 0.0, covariance = 0.0;
    for (const Eigen::Vector2d& point : points_px) {
      const double s = along.dot(point - mean);
      variance += s * s;
      covariance += s * across.dot(point - mean);
    }
    const double slope = covariance / variance;
    const auto departure = [&](const Eigen::Vector2d& point) {
      return std::abs(across.dot(point - mean) - slope * along.dot(point - mean));
    };
    const auto worst =
        std::max_element(points_px.begin(), points_px.end(),
                         [&](const auto& a, const auto& b) { return departure(a) < departure(b); });
    if (departure(*worst) <= max_departure_px) return ImageLine{mean, along + slope * across};
    points_px.erase(worst);
  }
  return std::nullopt;
}

// `map` is the quad's.
std::optional<ImageLine> FindSide(const cv::Mat& gray, const QuadCorners& quad,
                                  const UnitSquareMap& map, int side, const MarkerLook& look) {
  const double cell = 1.0 / look.cells.rows;
  std::vector<Eigen::Vector2d> steps;
  for (int i = 0; i < kNumScans; ++i) {
    const double along = kFirstScan + (1 - 2 * kFirstScan) * i / (kNumScans - 1.0);
    const Eigen::Vector2d inner = FromSide(side, along, kHalfScanCells * cell);
    const Eigen::Vector2d outer = FromSide(side, along, -kHalfScanCells * cell);
    const auto step =
        FindStep(gray, map.ToImage(inner.x(), inner.y()), map.ToImage(outer.x(), outer.y()), look);
    if (step) steps.push_back(*step);
  }
  const Eigen::Vector2d side_px = quad[static_cast<std::size_t>((side + 1) % kNumCorners)] -
                                  quad[static_cast<std::size_t>(side)];
  return FitLine(std::move(steps), side_px.normalized(),
                 std::max(kMaxDeparturePx, kMaxDepartureCells * cell * side_px.norm()));
}

std::optional<QuadCorners> FindSides(const cv::Mat& gray, const QuadCorners& quad,
                                     const MarkerLook& look) {
  const UnitSquareMap map(quad);
  std::array<ImageLine, kNumCorners> lines;
  for (int side = 0; side < kNumCorners; ++side) {
    const auto line = FindSide(gray, quad, map, side, look);
    if (!line) return std::nullopt;
    lines[static_cast<std::size_t>(side)] = *line;
  }
  const double max_shift_px = std::max(2.0, QuadMeanSide(quad) / look.cells.rows);
  QuadCorners corners;
  for (std::size_t c = 0; c < kNumCorners; ++c) {
    const auto corner = Intersect(lines[(c + kNumCorners - 1) % kNumCorners], lines[c]);
    if (!corner || (*corner - quad[c]).norm() > max_shift_px) return std::nullopt;
    corners[c] = *corner;
  }
  return corners;
}

// The middle of each cell of the marker and of one ring of light ones around it.
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
  cv::Point min(1 << 24, 1 << 24), max(-(1 << 24), -(1 << 24));
  for (int row = -1; row <= n; ++row) {
    for (int column = -1; column <= n; ++column) {
      const bool is_inside = row >= 0 && column >= 0 && row < n && column < n;
      const Eigen::Vector2d place = map.ToImage((column + 0.5) / n, (row + 0.5) / n);
      const cv::Point pixel(static_cast<int>(std::lround(place.x())),
                            static_cast<int>(std::lround(place.y())));
      places.pixels.push_back(pixel);
      const bool is_light = !is_inside || look.cells.at<std::uint8_t>(row, column) != 0;
      places.is_light.push_back(is_light);
      places.num_light += is_light;
      min = {std::min(min.x, pixel.x), std::min(min.y, pixel.y)};
      max = {std::max(max.x, pixel.x), std::max(max.y, pixel.y)};
    }
  }
  places.box = cv::Rect(min, max + cv::Point(1, 1));
  return places;
}

// Correlation of the grey values at the places, moved by so much, with what they should be.
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

// Looks for the move of the places that correlates best.
class ShiftSearch {
 public:
  ShiftSearch(const cv::Mat& gray, const CellPlaces& places, const MarkerLook& look)
      : gray_(gray), places_(places), look_(look), image_(0, 0, gray.cols, gray.rows) {}

  const cv::Point& best() const { return best_; }
  double best_correlation() const { return best_correlation_; }

  void LookAt(const cv::Point& shift) {
    const cv::Rect box = places_.box + shift;
    if ((box & image_) != box) return;
    const double correlation = Correlation(gray_, places_, shift, look_);
    if (correlation > best_correlation_) {
      best_correlation_ = correlation;
      best_ = shift;
    }
  }

  // The places of a grid that are `ring` steps off in one direction and no more in the other.
  void LookAtRing(const cv::Point& center, int ring, int step) {
    for (int y = -ring; y <= ring; ++y) {
      const int next = std::abs(y) == ring ? 1 : 2 * ring;
      for (int x = -ring; x <= ring; x += std::max(1, next)) {
        LookAt(center + step * cv::Point(x, y));
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

// From the middle outwards on a grid of half cells, then finer.
std::optional<cv::Point> FindShift(const cv::Mat& gray, const CellPlaces& places,
                                   const MarkerLook& look, double reach_px, double cell_px) {
  ShiftSearch search(gray, places, look);
  int step = std::max(1, static_cast<int>(0.5 * cell_px));
  const int num_rings = static_cast<int>(std::ceil(reach_px / step));
  for (int ring = 0; ring <= num_rings && search.best_correlation() < kSureCorrelation; ++ring) {
    search.LookAtRing({0, 0}, ring, step);
  }
  for (;; step /= 2) {
    cv::Point center;
    do {
      center = search.best();
      search.LookAtRing(center, 1, step);
    } while (search.best() != center);
    if (step == 1) break;
  }
  if (search.best_correlation() < kMinCorrelation) return std::nullopt;
  return search.best();
}

// Whether every cell is on its side of the middle grey level.
bool ShowsItsCells(const cv::Mat& gray, const QuadCorners& quad, const MarkerLook& look) {
  const UnitSquareMap map(quad);
  const int n = look.cells.rows;
  std::vector<double> values;
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      double value = 0.0;
      for (const double y : {0.3, 0.7}) {
        for (const double x : {0.3, 0.7}) {
          value += 0.25 * GrayAt(gray, map.ToImage((column + x) / n, (row + y) / n), look);
        }
      }
      const int is_light = look.cells.at<std::uint8_t>(row, column) != 0;
      sum[is_light] += value;
      ++count[is_light];
      values.push_back(value);
    }
  }
  if (count[1] == 0) return false;
  const double dark = sum[0] / count[0], light = sum[1] / count[1];
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

std::optional<QuadCorners> AlignSides(const cv::Mat& gray, const QuadCorners& quad,
                                      const MarkerLook& look) {
  VELAMAP_CHECK(gray.type() == CV_8UC1 && look.cells.type() == CV_8UC1);
  if (!HasCells(quad, look.cells.total())) return std::nullopt;
  // Again and again, as the levels were read beside sides that were off.
  std::optional<QuadCorners> aligned = quad;
  for (int look_idx = 0; look_idx < kMaxLooks; ++look_idx) {
    const QuadCorners last = *aligned;
    aligned = FindSides(gray, last, look);
    if (!aligned || MaxCornerShift(*aligned, last) < kSettledPx) break;
  }
  return aligned;
}

std::optional<QuadCorners> LocateMarker(const cv::Mat& gray, const QuadCorners& expected,
                                        const MarkerLook& look, double reach_px) {
  VELAMAP_CHECK(gray.type() == CV_8UC1 && look.cells.type() == CV_8UC1);
  if (!HasCells(expected, look.cells.total())) return std::nullopt;
  const double cell_px = QuadMeanSide(expected) / look.cells.rows;
  const auto shift = FindShift(gray, PlacesOfCells(expected, look), look, reach_px, cell_px);
  if (!shift) return std::nullopt;
  QuadCorners moved = expected;
  for (Eigen::Vector2d& corner : moved) corner += Eigen::Vector2d(shift->x, shift->y);
  const auto aligned = FindSides(gray, moved, look);
  if (!aligned || !ShowsItsCells(gray, *aligned, look)) return std::nullopt;
  return aligned;
}

}  // namespace velamap
