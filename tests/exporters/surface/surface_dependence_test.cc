// What a surface owes to each of its markers.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/surface/surface.h"
#include "tests/exporters/sail/example_surface.h"

namespace velamap {
namespace {

constexpr double kPlaces[] = {0.02, 0.3, 0.5, 0.8, 0.97};

SurfaceInput NoisySail() {
  SurfaceInput input = CornersOn(TwistedSail, 7, 9, 0.02, 0.01);
  AddNoise(0.002, true, 1, &input);
  return input;
}

TEST(SurfaceDependence, SharesOfTheMarkersSumToOneAndTheVariancesToThatOfTheSurface) {
  SurfaceOptions with_edge;
  for (int i = 0; i <= 10; ++i) with_edge.edges.luff.push_back(TwistedSail(-0.01, 0.1 * i));
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

TEST(SurfaceDependence, TheRootMeanSquareOfSigmasIsThatOfEvenPlaces) {
  FittedSurface fit = FitSurface(NoisySail());
  constexpr int kNum = 60;
  double sum = 0.0, area = 0.0;
  for (int i = 0; i < kNum * kNum; ++i) {
    const double u = (i / kNum + 0.5) / kNum, v = (i % kNum + 0.5) / kNum;
    const SurfaceJet jet = EvaluateJet(fit.surface, u, v);
    const double cell = jet.x_u.cross(jet.x_v).norm();
    sum += cell * std::pow(*SigmaAt(fit, u, v), 2);
    area += cell;
  }
  const double rms_m = RmsSigma(fit).value();
  EXPECT_NEAR(rms_m / std::sqrt(sum / area), 1.0, 0.01);
  fit.pole_covariance_m2 *= 4;
  EXPECT_NEAR(*RmsSigma(fit), 2 * rms_m, 1e-9);
}

TEST(SurfaceDependence, OfAnInterpolatingSurfaceIsUnknown) {
  const FittedSurface fit = FitSurface(AsExact(NoisySail()));
  EXPECT_FALSE(DependenceAt(fit, 0.5, 0.5).has_value());
  EXPECT_FALSE(RmsSigma(fit).has_value());
}

}  // namespace
}  // namespace velamap
