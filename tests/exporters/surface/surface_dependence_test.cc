// What a surface owes to each of its markers.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "exporters/surface/surface.h"
#include "tests/exporters/sail/example_surface.h"

namespace velamap {
namespace {

constexpr double kPlaces[] = {0.02, 0.3, 0.5, 0.8, 0.97};

TEST(SurfaceDependence, SharesOfTheMarkersSumToOneAndTheVariancesToThatOfTheSurface) {
  SurfaceOptions with_edge;
  for (int i = 0; i <= 10; ++i)
    with_edge.edges.luff.points_m.push_back(TwistedSail(-0.01, 0.1 * i));
  for (const SurfaceOptions& options : {SurfaceOptions(), with_edge}) {
    const FittedSurface fit = FitSurface(NoisySail(), options);
    EXPECT_EQ(fit.points.size(), 4 * 63u);
    for (const double u : kPlaces) {
      for (const double v : kPlaces) {
        const SurfaceDependence dependence = DependenceAt(fit, u, v).value();
        EXPECT_NEAR(dependence.point_weights.sum(), 1.0, 1e-6) << u << " " << v;
        EXPECT_GT(dependence.noise_variance_m2, 0.0);
        EXPECT_GT(dependence.smoothing_variance_m2, 0.0);
        EXPECT_NEAR(std::sqrt(dependence.noise_variance_m2 + dependence.smoothing_variance_m2),
                    *SigmaAt(fit, u, v), 1e-9);
      }
    }
  }
}

TEST(SurfaceDependence, AMarkerThatMovesTakesItsShareOfTheSurfaceAlong) {
  SurfaceInput input = NoisySail();
  const FittedSurface before = FitSurface(input);
  constexpr int kMovedId = 31;  // in the middle
  const auto share_of_moved = [&](double u, double v) {
    const Eigen::VectorXd weights = DependenceAt(before, u, v)->point_weights;
    double share = 0.0;
    for (std::size_t k = 0; k < before.points.size(); ++k) {
      if (before.points[k].marker_id == kMovedId) share += weights[static_cast<Eigen::Index>(k)];
    }
    return share;
  };
  const Eigen::Vector3d normal = EvaluateNormal(before.surface, 0.5, 0.5);
  constexpr double kMove_m = 1e-6;  // too little to change how much is smoothed
  ForEachMarker(&input, [&](SurfaceMarker* marker) {
    if (marker->marker_id == kMovedId) MoveMarker(kMove_m * normal, marker);
  });
  const FittedSurface after = FitSurface(input);
  double largest_share = 0.0;
  for (const double u : kPlaces) {
    for (const double v : kPlaces) {
      const double share = share_of_moved(u, v);
      const Eigen::Vector3d move_m =
          EvaluatePoint(after.surface, u, v) - EvaluatePoint(before.surface, u, v);
      const Eigen::Vector3d there = EvaluateNormal(before.surface, u, v);
      EXPECT_NEAR(move_m.dot(there) / kMove_m, share * normal.dot(there), 0.01) << u << " " << v;
      largest_share = std::max(largest_share, share);
    }
  }
  EXPECT_GT(largest_share, 0.1);
}

TEST(SurfaceDependence, OfAnInterpolatingSurfaceIsUnknown) {
  EXPECT_FALSE(DependenceAt(FitSurface(AsExact(NoisySail())), 0.5, 0.5).has_value());
}

}  // namespace
}  // namespace velamap
