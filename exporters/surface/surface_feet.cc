#include "exporters/surface/surface_feet.h"

#include <algorithm>

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

// The least and greatest u and v of the markers.
struct Bounds {
  Eigen::Array2d least = Eigen::Array2d::Ones(), greatest = Eigen::Array2d::Zero();
};

Bounds BoundsOf(const SurfaceParameters& parameters) {
  Bounds bounds;
  for (const SurfaceObservation& observation : parameters.observations) {
    if (observation.marker_id < 0) continue;
    const Eigen::Array2d uv(observation.u, observation.v);
    bounds.least = bounds.least.min(uv);
    bounds.greatest = bounds.greatest.max(uv);
  }
  return bounds;
}

}  // namespace

OpenSides OpenSidesOf(const SurfaceParameters& parameters, const SurfaceEdges& edges) {
  constexpr double kOnEdge = 1e-9;
  const Bounds bounds = BoundsOf(parameters);
  OpenSides open{bounds.least > kOnEdge, bounds.greatest < 1 - kOnEdge};
  open.at_least[0] = open.at_least[0] || !edges.luff.empty();
  open.at_greatest[0] = open.at_greatest[0] || !edges.leech.empty();
  open.at_least[1] = open.at_least[1] || !edges.foot.empty();
  open.at_greatest[1] = open.at_greatest[1] || !edges.head.empty();
  return open;
}

void MoveMarkersToFeet(const SplineSurface& surface, const OpenSides& open,
                       SurfaceParameters* parameters) {
  for (SurfaceObservation& observation : parameters->observations) {
    if (observation.marker_id >= 0) MoveToFeet(surface, &observation);
  }
  const Bounds bounds = BoundsOf(*parameters);
  const Eigen::Array2d first = open.at_least.select(Eigen::Array2d::Zero(), bounds.least);
  const Eigen::Array2d last = open.at_greatest.select(Eigen::Array2d::Ones(), bounds.greatest);
  const auto rescale = [&](auto* place) {
    place->u = (place->u - first[0]) / (last[0] - first[0]);
    place->v = (place->v - first[1]) / (last[1] - first[1]);
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
