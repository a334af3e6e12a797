#include "exporters/surface/surface_feet.h"

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace velamap {
namespace {

// Each fit moves the feet only a little, so a few Gauss-Newton steps are enough.
void MoveToFoot(const SplineSurface& surface, SurfaceObservation* observation) {
  constexpr int kNumSteps = 3;
  for (int step = 0; step < kNumSteps; ++step) {
    const SurfaceJet jet = EvaluateJet(surface, observation->u, observation->v);
    Eigen::Matrix<double, 3, 2> tangents;
    tangents << jet.x_u, jet.x_v;
    const Eigen::Matrix2d normal = tangents.transpose() * tangents;
    const Eigen::Vector2d move =
        normal.ldlt().solve(tangents.transpose() * (observation->OnCloth() - jet.x));
    observation->u += move[0];
    observation->v += move[1];
  }
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

void MoveToFeet(const SplineSurface& surface, const OpenSides& open,
                SurfaceParameters* parameters) {
  for (SurfaceObservation& observation : parameters->observations) {
    if (observation.marker_id >= 0) MoveToFoot(surface, &observation);
  }
  const Bounds bounds = BoundsOf(*parameters);
  const Eigen::Array2d first = open.at_least.select(Eigen::Array2d::Zero(), bounds.least);
  const Eigen::Array2d last = open.at_greatest.select(Eigen::Array2d::Ones(), bounds.greatest);
  for (SurfaceObservation& observation : parameters->observations) {
    observation.u = (observation.u - first[0]) / (last[0] - first[0]);
    observation.v = (observation.v - first[1]) / (last[1] - first[1]);
  }
}

void SetSags(const SplineSurface& surface, SurfaceParameters* parameters) {
  for (SurfaceObservation& observation : parameters->observations) {
    if (observation.side_m <= 0) continue;
    const SurfaceJet jet = EvaluateJet(surface, observation.u, observation.v);
    const double uu = jet.x_u.squaredNorm(), uv = jet.x_u.dot(jet.x_v), vv = jet.x_v.squaredNorm();
    const double area = uu * vv - uv * uv;
    if (area <= 0) continue;
    const double mean_curvature =
        (uu * jet.normal.dot(jet.x_vv) - 2 * uv * jet.normal.dot(jet.x_uv) +
         vv * jet.normal.dot(jet.x_uu)) /
        (2 * area);
    observation.sag_m = -mean_curvature * observation.side_m * observation.side_m / 4 * jet.normal;
  }
}

void MoveMarkersBetweenLinesToFeet(const SplineSurface& surface, SurfaceParameters* parameters) {
  for (SurfaceObservation& observation : parameters->observations) {
    if (observation.marker_id < 0 || !observation.line.empty()) continue;
    MoveToFoot(surface, &observation);
    observation.u = std::clamp(observation.u, 0.0, 1.0);
    observation.v = std::clamp(observation.v, 0.0, 1.0);
  }
}

}  // namespace velamap
