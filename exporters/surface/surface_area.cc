#include "exporters/surface/surface_area.h"

#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "exporters/surface/surface_rows.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

// Limits of the ratio of the surface's area to the area of straight strips between the lines. A
// half cylinder has a ratio of 1.57.
constexpr double kMaxAreaRatio = 1.6, kMaxAreaRatioWithEdges = 4.0;

// The point of a polyline at a fraction of its length.
Eigen::Vector3d PointAtFraction(const std::vector<Eigen::Vector3d>& points, double fraction) {
  const std::vector<double> lengths_m = ChordLengths(points);
  const double wanted_m = fraction * lengths_m.back();
  std::size_t i = 1;
  while (i + 1 < points.size() && lengths_m[i] < wanted_m) ++i;
  const double part = (wanted_m - lengths_m[i - 1]) / (lengths_m[i] - lengths_m[i - 1]);
  return points[i - 1] + part * (points[i] - points[i - 1]);
}

// Area of straight strips from line to line.
double RuledArea(const std::vector<SurfaceLine>& lines) {
  constexpr int kNumStrips = 50;
  std::vector<std::vector<Eigen::Vector3d>> polylines;
  for (const SurfaceLine& line : lines) polylines.push_back(PresentPoints(line));
  double area_m2 = 0.0;
  for (std::size_t j = 1; j < polylines.size(); ++j) {
    for (int i = 0; i < kNumStrips; ++i) {
      const double from = i / static_cast<double>(kNumStrips);
      const double to = (i + 1) / static_cast<double>(kNumStrips);
      const Eigen::Vector3d a = PointAtFraction(polylines[j - 1], from),
                            b = PointAtFraction(polylines[j - 1], to);
      const Eigen::Vector3d c = PointAtFraction(polylines[j], to),
                            d = PointAtFraction(polylines[j], from);
      area_m2 += (c - a).cross(d - b).norm() / 2;
    }
  }
  return area_m2;
}

}  // namespace

void CheckArea(const SortedInput& sorted, const SurfaceOptions& ends,
               const SplineSurface& surface) {
  const SurfaceEdges& edges = ends.edges;
  bool is_extended = false;
  for (const auto& extension_mm : {ends.luff_extension_mm, ends.leech_extension_mm,
                                   ends.foot_extension_mm, ends.head_extension_mm}) {
    is_extended = is_extended || extension_mm.value_or(0.0) > 0;
  }
  for (const SurfaceLine& line : sorted.lines) {
    is_extended = is_extended || line.luff_offset_m.value_or(0.0) > 0 ||
                  line.leech_offset_m.value_or(0.0) > 0;
  }
  bool has_edges = false;
  for (const auto* edge : {&edges.luff, &edges.leech, &edges.foot, &edges.head}) {
    has_edges = has_edges || !edge->points_m.empty();
  }
  const double max_ratio = is_extended || has_edges ? kMaxAreaRatioWithEdges : kMaxAreaRatio;
  const double area_m2 = SurfaceArea(surface), ruled_area_m2 = RuledArea(sorted.lines);
  if (area_m2 <= max_ratio * ruled_area_m2) return;
  throw DataError(fmt::format(
      "the surface would oscillate between the markers ({:.3g} m2 instead of about {:.3g} m2); "
      "check the errors of the markers and the order of the lines{}",
      area_m2, ruled_area_m2, is_extended ? ", or extend the surface by less" : ""));
}

}  // namespace velamap
