#include "exporters/surface/surface_feet.h"

#include <algorithm>
#include <cmath>

namespace velamap {
namespace {

// Each fit moves the feet only a little, so a few steps are enough.
void MoveToFoot(const SplineSurface& surface, PlacedPoint* point) {
  constexpr int kNumSteps = 3;
  for (int step = 0; step < kNumSteps; ++step) {
    const Eigen::Vector2d move =
        StepToFoot(EvaluateJet(surface, point->u, point->v), point->x_in_shape_m);
    point->u += move[0];
    point->v += move[1];
  }
}

// Moves all points alike, so that their mean comes to u and v.
void MoveAlike(double u, double v, SurfaceObservation* observation) {
  for (PlacedPoint& point : observation->points) {
    point.u += u - observation->u;
    point.v += v - observation->v;
  }
  observation->u = u;
  observation->v = v;
}

// Moves each point to its foot.
void MoveToFeet(const SplineSurface& surface, SurfaceObservation* observation) {
  double sum_u = 0.0, sum_v = 0.0;
  for (PlacedPoint& point : observation->points) {
    MoveToFoot(surface, &point);
    sum_u += point.u;
    sum_v += point.v;
  }
  observation->u = sum_u / static_cast<double>(observation->points.size());
  observation->v = sum_v / static_cast<double>(observation->points.size());
}

void MoveAllToFeet(const SplineSurface& surface, SurfaceParameters* parameters) {
  for (SurfaceObservation& observation : parameters->observations) {
    MoveToFeet(surface, &observation);
  }
}

Eigen::Vector2d PlaceOf(const SurfaceObservation& observation) {
  return {observation.u, observation.v};
}

// The foot of the middle of a marker. The mean of the feet of its corners is beside it where u and
// v do not grow evenly.
Eigen::Vector2d FootOfCenter(const SplineSurface& surface, const SurfaceObservation& observation) {
  PlacedPoint center{observation.Center(), observation.u, observation.v};
  MoveToFoot(surface, &center);
  return {center.u, center.v};
}

// The place at a distance along the surface, on a straight line in u and v.
Eigen::Vector2d WalkFrom(const SplineSurface& surface, const Eigen::Vector2d& from_uv,
                         const Eigen::Vector2d& direction_uv, double length_m) {
  constexpr int kNumSteps = 8;
  const auto step_at = [&](const Eigen::Vector2d& uv) -> Eigen::Vector2d {
    const SurfaceJet jet = EvaluateJet(surface, uv[0], uv[1]);
    const double m_per_direction = (jet.x_u * direction_uv[0] + jet.x_v * direction_uv[1]).norm();
    if (m_per_direction <= 0) return Eigen::Vector2d::Zero();
    return length_m / kNumSteps / m_per_direction * direction_uv;
  };
  Eigen::Vector2d uv = from_uv;
  for (int step = 0; step < kNumSteps; ++step) uv += step_at(uv + step_at(uv) / 2);
  return uv;
}

// The end of a row, which continues from its outer point in the direction of the row there. A near
// neighbour would multiply its own error, so the direction comes from one that is at least as far
// away as the end.
Eigen::Vector2d EndOf(const SplineSurface& surface, const SurfaceParameters& parameters,
                      std::size_t outer_idx, std::size_t opposite_idx, double length_m) {
  const auto& observations = parameters.observations;
  const Eigen::Vector2d outer_uv = FootOfCenter(surface, observations[outer_idx]);
  if (length_m <= 0) return outer_uv;
  const Eigen::Vector3d outer_m = observations[outer_idx].Center();
  std::size_t inner_idx = outer_idx;
  while (inner_idx != opposite_idx &&
         (observations[inner_idx].Center() - outer_m).norm() < length_m) {
    inner_idx = inner_idx < opposite_idx ? inner_idx + 1 : inner_idx - 1;
  }
  return WalkFrom(surface, outer_uv, outer_uv - FootOfCenter(surface, observations[inner_idx]),
                  length_m);
}

// The direction in (u, v) that is at a right angle to constant v on the surface, upwards.
Eigen::Vector2d AcrossRow(const SplineSurface& surface, const Eigen::Vector2d& uv) {
  const SurfaceJet jet = EvaluateJet(surface, uv[0], uv[1]);
  const double square_m2 = jet.x_u.squaredNorm();
  return {square_m2 > 0 ? -jet.x_u.dot(jet.x_v) / square_m2 : 0.0, 1.0};
}

// The places of the outline beside an outer row and its ends, `length_m` from them upwards, or
// downwards where it is negative.
std::vector<Eigen::Vector2d> BesideRow(const SplineSurface& surface,
                                       const SurfaceParameters& parameters, const ObservedRow& row,
                                       const Eigen::Vector2d& luff_uv,
                                       const Eigen::Vector2d& leech_uv, double length_m) {
  std::vector<Eigen::Vector2d> places = {luff_uv};
  for (std::size_t k = row.first_idx; k <= row.last_idx; ++k) {
    places.push_back(FootOfCenter(surface, parameters.observations[k]));
  }
  places.push_back(leech_uv);
  if (length_m == 0) return places;
  const double up = length_m > 0 ? 1.0 : -1.0;
  for (Eigen::Vector2d& uv : places) {
    uv = WalkFrom(surface, uv, up * AcrossRow(surface, uv), std::abs(length_m));
  }
  return places;
}

// Whether the end of a row shows where luff or leech are. If these are known, foot and head need
// not reach them. If foot or head are close to a line, their ends would turn the edge round.
bool ShowsSide(const SurfaceParameters& parameters, const ObservedEdge& edge,
               const std::vector<Eigen::Vector2d>& row_ends, std::size_t row) {
  constexpr double kNear = 0.25;  // of the mean distance of the rows
  if (!parameters.rows[row].is_edge) return true;
  if (edge.is_known) return false;
  const std::size_t next = row == 0 ? 1 : row - 1;
  const double mean =
      (row_ends.back()[1] - row_ends.front()[1]) / static_cast<double>(row_ends.size() - 1);
  return std::abs(row_ends[row][1] - row_ends[next][1]) > kNear * mean;
}

// The places on luff or leech, from foot to head: the ends of the rows, and the points of the edge
// between them. `outwards` is the direction of u to the edge.
std::vector<Eigen::Vector2d> AlongSide(const SplineSurface& surface,
                                       const SurfaceParameters& parameters,
                                       const ObservedEdge& edge,
                                       const std::vector<Eigen::Vector2d>& row_ends,
                                       double outwards) {
  std::vector<Eigen::Vector2d> places;
  for (std::size_t j = 0; j < row_ends.size(); ++j) {
    if (ShowsSide(parameters, edge, row_ends, j)) places.push_back(row_ends[j]);
  }
  for (std::size_t k = edge.first_idx; k < edge.first_idx + edge.num_points; ++k) {
    const Eigen::Vector2d uv = FootOfCenter(surface, parameters.observations[k]);
    places.push_back(edge.beyond_m > 0
                         ? WalkFrom(surface, uv, Eigen::Vector2d(outwards, 0), edge.beyond_m)
                         : uv);
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a[1] < b[1]; });
  return places;
}

// The observations have to be at their feet.
SurfaceOutline OutlineAtFeet(const SplineSurface& surface, const SurfaceParameters& parameters) {
  std::vector<Eigen::Vector2d> firsts, lasts;
  for (const ObservedRow& row : parameters.rows) {
    firsts.push_back(EndOf(surface, parameters, row.first_idx, row.last_idx, row.before_m));
    lasts.push_back(EndOf(surface, parameters, row.last_idx, row.first_idx, row.after_m));
  }
  const auto& rows = parameters.rows;
  SurfaceOutline outline;
  outline.luff = AlongSide(surface, parameters, parameters.luff, firsts, -1.0);
  outline.leech = AlongSide(surface, parameters, parameters.leech, lasts, 1.0);
  outline.foot = BesideRow(surface, parameters, rows.front(), firsts.front(), lasts.front(),
                           -parameters.below_m);
  outline.head =
      BesideRow(surface, parameters, rows.back(), firsts.back(), lasts.back(), parameters.above_m);
  return outline;
}

}  // namespace

SurfaceOutline OutlineOf(const SplineSurface& surface, SurfaceParameters parameters) {
  MoveAllToFeet(surface, &parameters);
  return OutlineAtFeet(surface, parameters);
}

void MoveMarkersToFeet(const SplineSurface& surface, SurfaceParameters* parameters) {
  MoveAllToFeet(surface, parameters);
  const SurfaceOutline outline = OutlineAtFeet(surface, *parameters);
  Eigen::Vector2d least = PlaceOf(parameters->observations.front()), greatest = least;
  const auto include = [&](const Eigen::Vector2d& uv) {
    least = least.cwiseMin(uv);
    greatest = greatest.cwiseMax(uv);
  };
  for (const auto* places : {&outline.luff, &outline.leech, &outline.foot, &outline.head}) {
    for (const Eigen::Vector2d& uv : *places) include(uv);
  }
  for (const SurfaceObservation& observation : parameters->observations) {
    include(PlaceOf(observation));
  }
  const auto rescale = [&](auto* place) {
    place->u = (place->u - least[0]) / (greatest[0] - least[0]);
    place->v = (place->v - least[1]) / (greatest[1] - least[1]);
  };
  for (SurfaceObservation& observation : parameters->observations) {
    rescale(&observation);
    for (PlacedPoint& point : observation.points) rescale(&point);
  }
}

void MoveCornersAroundMarkers(const SplineSurface& surface, SurfaceParameters* parameters) {
  for (SurfaceObservation& observation : parameters->observations) {
    if (observation.marker_id < 0) continue;
    const double u = observation.u, v = observation.v;
    MoveToFeet(surface, &observation);
    MoveAlike(u, v, &observation);
  }
}

void MoveMarkersBetweenLinesToFeet(const SplineSurface& surface, SurfaceParameters* parameters) {
  for (SurfaceObservation& observation : parameters->observations) {
    if (observation.marker_id < 0 || !observation.line.empty()) continue;
    PlacedPoint center{observation.Center(), observation.u, observation.v};
    MoveToFoot(surface, &center);
    MoveAlike(std::clamp(center.u, 0.0, 1.0), std::clamp(center.v, 0.0, 1.0), &observation);
  }
}

}  // namespace velamap
