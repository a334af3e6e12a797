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

// The end of a row: continued from its outer point as it runs there. A near neighbour would
// multiply its own error, so the direction comes from one at least as far away as the end is.
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

// v at a u of a row, linear between its points.
double HeightAt(const SurfaceParameters& parameters, const ObservedRow& row, double u) {
  const auto begin = parameters.observations.begin();
  const auto first = begin + static_cast<std::ptrdiff_t>(row.first_idx) + 1;
  const auto last = begin + static_cast<std::ptrdiff_t>(row.last_idx);
  const auto above = std::find_if(first, last, [u](const auto& point) { return point.u > u; });
  const auto below = above - 1;
  if (above->u <= below->u) return below->v;
  return below->v + (u - below->u) / (above->u - below->u) * (above->v - below->v);
}

// The places of the outline beside an outer row and its ends, `length_m` from them on average. The
// neighbouring row, on the other side, tells where it is more and where less.
std::vector<Eigen::Vector2d> BesideRow(const SplineSurface& surface,
                                       const SurfaceParameters& parameters, const ObservedRow& row,
                                       const ObservedRow& neighbor, const Eigen::Vector2d& luff_uv,
                                       const Eigen::Vector2d& leech_uv, double length_m) {
  std::vector<Eigen::Vector2d> places = {luff_uv};
  for (std::size_t k = row.first_idx; k <= row.last_idx; ++k) {
    places.push_back(FootOfCenter(surface, parameters.observations[k]));
  }
  places.push_back(leech_uv);
  if (length_m <= 0) return places;
  std::vector<Eigen::Vector2d> moves;  // as far as the neighbour
  double sum = 0.0;                    // of how much farther than `length_m` that is
  for (const Eigen::Vector2d& uv : places) {
    const double gap = uv[1] - HeightAt(parameters, neighbor, uv[0]);
    const double up = gap > 0 ? 1.0 : -1.0;
    const Eigen::Vector2d move = WalkFrom(surface, uv, up * AcrossRow(surface, uv), length_m) - uv;
    const double farther = std::abs(gap / move[1]);
    moves.push_back(farther * move);
    sum += farther;
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    places[k] += static_cast<double>(places.size()) / sum * moves[k];
  }
  return places;
}

// The observations have to be at their feet.
SurfaceOutline OutlineAtFeet(const SplineSurface& surface, const SurfaceParameters& parameters) {
  SurfaceOutline outline;
  for (const ObservedRow& row : parameters.rows) {
    outline.luff.push_back(EndOf(surface, parameters, row.first_idx, row.last_idx, row.before_m));
    outline.leech.push_back(EndOf(surface, parameters, row.last_idx, row.first_idx, row.after_m));
  }
  const auto& rows = parameters.rows;
  outline.foot = BesideRow(surface, parameters, rows.front(), rows[1], outline.luff.front(),
                           outline.leech.front(), parameters.below_m);
  outline.head = BesideRow(surface, parameters, rows.back(), rows[rows.size() - 2],
                           outline.luff.back(), outline.leech.back(), parameters.above_m);
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
