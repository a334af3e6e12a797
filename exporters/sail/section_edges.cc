#include "exporters/sail/section_edges.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "exporters/curve/section_spline.h"
#include "exporters/shape/sail_lines.h"

namespace velamap {
namespace {

// Points in the same place as the one before count once.
std::optional<SpaceCurve> CurveThrough(std::vector<Eigen::Vector3d> points_m,
                                       const Eigen::Vector3d& up) {
  const auto is_same = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a - b).norm() < kSamePlace_m;
  };
  points_m.erase(std::unique(points_m.begin(), points_m.end(), is_same), points_m.end());
  if (points_m.size() < 2) return std::nullopt;
  if (up.dot(points_m.back() - points_m.front()) < 0)
    std::reverse(points_m.begin(), points_m.end());
  Eigen::Matrix3Xd x_m(3, static_cast<Eigen::Index>(points_m.size()));
  for (Eigen::Index i = 0; i < x_m.cols(); ++i) x_m.col(i) = points_m[static_cast<std::size_t>(i)];
  const Interpolation through = MakeInterpolation(ChordLengthParameters(x_m));
  return SpaceCurve{through.degree, through.knots, x_m * through.poles_from_points};
}

SideEdge FindSideEdge(const MarkerShape& shape, const LayoutPart& part, const ClothEdge& edge,
                      const Eigen::Vector3d& up) {
  return {edge, CurveThrough(WholePoints(shape, PointsAlongSide(part, edge)), up)};
}

// The distance of the curve from the end, seen along the normal of the cloth. The line goes on
// along an arc, which is longer than the straight distance.
std::optional<double> DistanceToCurve(const SpaceCurve& curve, const CurveEnd& end,
                                      const Eigen::Vector3d& up) {
  constexpr double kSlack = 0.02;  // of the curve's height, beyond which it does not pass the end
  constexpr double kMinCosine = 0.5;
  const Eigen::Vector3d across = (up - end.outwards * end.outwards.dot(up)).normalized();
  const double height_m = across.dot(end.x_in_shape_m);
  const double low_m = across.dot(EvaluateCurve(curve, 0.0));
  const double high_m = across.dot(EvaluateCurve(curve, 1.0));
  const double slack_m = kSlack * (high_m - low_m);
  if (!(height_m >= low_m - slack_m && height_m <= high_m + slack_m)) return std::nullopt;
  const double parameter = ParameterAtHeight(curve, across, std::clamp(height_m, low_m, high_m));
  const Eigen::Vector3d rest_m = EvaluateCurve(curve, parameter) - end.x_in_shape_m;
  const double distance_m = rest_m.norm();
  if (distance_m < kSamePlace_m) return 0.0;
  const double cosine = end.outwards.dot(rest_m) / distance_m;
  if (cosine < kMinCosine) return std::nullopt;
  const double angle = std::acos(std::min(cosine, 1.0));
  return angle < 1e-6 ? distance_m : distance_m * angle / std::sin(angle);
}

}  // namespace

SideEdges FindSideEdges(const MarkerShape& shape, const LayoutPart& part,
                        const Eigen::Vector3d& up) {
  return {FindSideEdge(shape, part, part.edges.luff, up),
          FindSideEdge(shape, part, part.edges.leech, up)};
}

std::optional<double> DistanceToEdge(const SideEdge& edge, const CurveEnd& end,
                                     const Eigen::Vector3d& up) {
  if (!edge.in_layout.HasPlaces()) {
    return end.is_at_outer_marker ? edge.in_layout.OffsetOfLine(end.line_idx) : std::nullopt;
  }
  if (!edge.curve) return std::nullopt;
  const std::optional<double> distance_m = DistanceToCurve(*edge.curve, end, up);
  if (!distance_m) return std::nullopt;
  return *distance_m + edge.in_layout.OffsetOfLine(0).value_or(0.0);
}

}  // namespace velamap
