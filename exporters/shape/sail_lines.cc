#include "exporters/shape/sail_lines.h"

#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/geometry/principal_axes.h"

namespace velamap {
namespace {

std::vector<Eigen::Vector3d> WholeCenters(const MarkerShape& shape, const MarkerLine& line) {
  std::vector<Eigen::Vector3d> centers;
  for (const int id : line.marker_ids) {
    if (FindWholeMarker(shape, id) != nullptr) centers.push_back(CenterOf(shape, id));
  }
  return centers;
}

// Sum over the lines of the unit vectors from the first to the last whole marker.
Eigen::Vector3d SumOfDirections(const MarkerShape& shape, const std::vector<MarkerLine>& lines) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const MarkerLine& line : lines) {
    const std::vector<Eigen::Vector3d> centers = WholeCenters(shape, line);
    if (centers.size() >= 2) sum += (centers.back() - centers.front()).normalized();
  }
  return sum;
}

std::optional<Eigen::Vector3d> UnitOrNothing(const Eigen::Vector3d& direction) {
  constexpr double kMinLength = 1e-6;
  if (direction.norm() < kMinLength) return std::nullopt;
  return direction.normalized();
}

Eigen::Vector3d FromLowestToHighest(const MarkerShape& shape,
                                    const std::vector<MarkerLine>& lines) {
  std::vector<Eigen::Vector3d> means;
  for (const MarkerLine& line : lines) {
    const std::vector<Eigen::Vector3d> centers = WholeCenters(shape, line);
    if (centers.size() < 2) continue;
    means.push_back((centers.front() + centers.back()) / 2);
  }
  if (means.size() < 2) return Eigen::Vector3d::Zero();
  return means.back() - means.front();
}

}  // namespace

Eigen::Vector3d CenterOf(const MarkerShape& shape, int marker_id) {
  const ShapeMarker* marker = FindWholeMarker(shape, marker_id);
  VELAMAP_CHECK(marker != nullptr);
  return *marker->x_in_shape_m[0];
}

std::vector<Eigen::Vector3d> WholePoints(const MarkerShape& shape,
                                         const std::vector<CornerId>& points) {
  std::vector<Eigen::Vector3d> points_m;
  for (const CornerId& point : points) {
    const ShapeMarker* marker = FindWholeMarker(shape, point.marker_id);
    if (marker == nullptr) continue;
    points_m.push_back(*marker->x_in_shape_m[static_cast<std::size_t>(point.corner)]);
  }
  return points_m;
}

std::vector<CornerId> PointsAlongSide(const LayoutPart& part, const ClothEdge& edge) {
  std::vector<CornerId> points = edge.points;
  for (const MarkerLine& line : part.vertical) {
    if (line.name != edge.line) continue;
    for (const int id : line.marker_ids) points.push_back({id, 0});
  }
  return points;
}

std::vector<int> MarkersOfPart(const Layout& layout, const std::string& part) {
  std::vector<int> ids;
  std::set<int> seen;
  const auto add = [&](const std::vector<int>& more) {
    for (const int id : more) {
      if (seen.insert(id).second) ids.push_back(id);
    }
  };
  for (const LayoutPart& candidate : layout.parts) {
    if (candidate.name != part) continue;
    for (const MarkerLine& line : candidate.horizontal) add(line.marker_ids);
    for (const MarkerLine& line : candidate.vertical) add(line.marker_ids);
    add(candidate.marker_ids);
  }
  return ids;
}

std::vector<const MarkerLine*> LinesWithEnds(const MarkerShape& shape,
                                             const std::vector<MarkerLine>& lines) {
  std::vector<const MarkerLine*> with_ends;
  for (const MarkerLine& line : lines) {
    if (line.marker_ids.size() < 2) continue;
    if (FindWholeMarker(shape, line.marker_ids.front()) == nullptr) continue;
    if (FindWholeMarker(shape, line.marker_ids.back()) == nullptr) continue;
    with_ends.push_back(&line);
  }
  return with_ends;
}

LineEnds EndsOf(const MarkerShape& shape, const MarkerLine& line) {
  return {CenterOf(shape, line.marker_ids.front()), CenterOf(shape, line.marker_ids.back())};
}

std::optional<Eigen::Vector3d> SailUp(const MarkerShape& shape, const LayoutPart& part) {
  const auto up = UnitOrNothing(SumOfDirections(shape, part.vertical));
  return up ? up : LinesUp(shape, part);
}

std::optional<Eigen::Vector3d> LinesUp(const MarkerShape& shape, const LayoutPart& part) {
  return UnitOrNothing(FromLowestToHighest(shape, part.horizontal));
}

std::optional<Eigen::Vector3d> SailUp(const MarkerShape& shape, const Layout& layout) {
  const LayoutPart* part = FirstPartWithLines(layout);
  return part == nullptr ? std::nullopt : SailUp(shape, *part);
}

bool PointsDown(const Eigen::Vector3d& direction, const Eigen::Vector3d& up) {
  constexpr double kMinCosine = 0.5;
  return direction.dot(up) < -kMinCosine * direction.norm();
}

std::string DoubtAboutSailUp(const MarkerShape& shape, const Layout& layout) {
  constexpr double kClearMajority = 0.75;
  const LayoutPart* part = FirstPartWithLines(layout);
  const std::optional<Eigen::Vector3d> up = SailUp(shape, layout);
  if (part == nullptr || !up) return "";
  int num_whole = 0, num_against = 0;
  for (const int id : MarkersOfPart(layout, part->name)) {
    const ShapeMarker* marker = FindWholeMarker(shape, id);
    if (marker == nullptr) continue;
    ++num_whole;
    if (PointsDown(MarkerUp(*marker), *up)) ++num_against;
  }
  if (num_against == 0 || num_against < kClearMajority * num_whole) return "";
  return fmt::format(
      "{} of the {} markers of '{}' stand upside down if its lines are in the order of the layout; "
      "list horizontal lines, and the markers of vertical ones, from foot to head; if the markers "
      "are glued upside down, all is right",
      num_against, num_whole, part->name);
}

std::optional<Eigen::Vector3d> LuffDirection(const MarkerShape& shape, const LayoutPart& part) {
  std::vector<Eigen::Vector3d> luff;
  for (const MarkerLine& line : part.horizontal) {
    const int id = line.marker_ids.front();
    if (FindWholeMarker(shape, id) != nullptr) luff.push_back(CenterOf(shape, id));
  }
  if (luff.size() < 2) return std::nullopt;
  const Eigen::Vector3d along = ComputePrincipalAxes(luff).directions.col(2);
  const Eigen::Vector3d up = luff.back() - luff.front();
  return UnitOrNothing(along.dot(up) < 0 ? Eigen::Vector3d(-along) : along);
}

std::optional<Eigen::Vector3d> SailAft(const MarkerShape& shape, const Layout& layout) {
  const LayoutPart* part = FirstPartWithLines(layout);
  if (part == nullptr) return std::nullopt;
  return UnitOrNothing(SumOfDirections(shape, part->horizontal));
}

int BulgeSide(const MarkerShape& shape, const Layout& layout, const Eigen::Vector3d& direction) {
  constexpr double kMinBulge = 1e-3;
  double bulge_m = 0.0, chord_m = 0.0;
  const LayoutPart* part = FirstPartWithLines(layout);
  if (part == nullptr) return 0;
  for (const MarkerLine& line : part->horizontal) {
    const std::vector<Eigen::Vector3d> centers = WholeCenters(shape, line);
    if (centers.size() < 3) continue;
    const Eigen::Vector3d chord = centers.back() - centers.front();
    double depth_m = 0.0;
    for (std::size_t i = 1; i + 1 < centers.size(); ++i) {
      const Eigen::Vector3d rest = centers[i] - centers.front();
      depth_m += direction.dot(rest - chord * (chord.dot(rest) / chord.squaredNorm()));
    }
    bulge_m += depth_m / static_cast<double>(centers.size() - 2);
    chord_m += chord.norm();
  }
  if (std::abs(bulge_m) <= kMinBulge * chord_m) return 0;
  return bulge_m > 0 ? 1 : -1;
}

std::string MissingEndsText(int num_at_luff, int num_at_leech) {
  if (num_at_luff + num_at_leech == 0) return "";
  const auto [first, end] =
      num_at_luff > 0 ? std::pair{num_at_luff, "luff"} : std::pair{num_at_leech, "leech"};
  return fmt::format(
      "{} marker{} missing at the {}{}", first, first == 1 ? "" : "s", end,
      num_at_luff > 0 && num_at_leech > 0 ? fmt::format(" and {} at the leech", num_at_leech) : "");
}

}  // namespace velamap
