#include "importer/detect/marker_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "importer/base/error.h"
#include "importer/detect/gray_levels.h"
#include "importer/detect/interpolate.h"
#include "importer/geometry/unit_square_map.h"

namespace velamap {
namespace {

// Scans across a side: their number, how many have to find the edge, and the fraction of the side
// that is left out at either end.
constexpr int kNumScans = 9;
constexpr int kMinScans = 6;
constexpr double kFirstScan = 0.14;
constexpr double kHalfScanCells = 0.5;
constexpr int kMaxScanSteps = 40;

// How far the edge of one scan may lie from the line through the others.
constexpr double kMaxDeparturePx = 0.7;
constexpr double kMaxDepartureCells = 0.12;

// A quad that moves less than this is aligned.
constexpr double kSettledPx = 0.01;
constexpr int kMaxAlignments = 6;

// Place in the unit square of the marker: `along` a side, from corner `side` on, and `inwards` of
// it.
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

// The first place between `inner` and `outer` where the grey level is halfway between theirs.
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

// Line fit by least squares. Points that depart by more than `max_departure_px` are left out, the
// worst one first.
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

// `map` belongs to `quad`.
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

}  // namespace

double GrayAt(const cv::Mat& gray, const Eigen::Vector2d& x_px, const MarkerLook& look) {
  const double value = InterpolateGray(gray, x_px);
  return look.is_inverted ? 255.0 - value : value;
}

std::optional<QuadCorners> AlignSidesOnce(const cv::Mat& gray, const QuadCorners& quad,
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

std::optional<QuadCorners> AlignSides(const cv::Mat& gray, const QuadCorners& quad,
                                      const MarkerLook& look) {
  VELAMAP_CHECK(gray.type() == CV_8UC1 && look.cells.type() == CV_8UC1);
  if (!HasCells(quad, look.cells.total())) return std::nullopt;
  // Repeated, because the grey levels are read beside sides that are not aligned yet.
  std::optional<QuadCorners> aligned = quad;
  for (int round = 0; round < kMaxAlignments; ++round) {
    const QuadCorners last = *aligned;
    aligned = AlignSidesOnce(gray, last, look);
    if (!aligned || MaxCornerShift(*aligned, last) < kSettledPx) break;
  }
  return aligned;
}

}  // namespace velamap
