#include "exporters/cloth/surface_sigma.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "tests/exporters/sail/example_surface.h"

namespace velamap {
namespace {

// All corners of the fit move together, by `shared_sigma_m` along each axis.
PointCovariance SharedBy(const FittedSurface& fit, double shared_sigma_m) {
  PointCovariance covariance;
  for (const CornerId& id : fit.points) covariance.point3D_ids.push_back(Point3DIdFromCorner(id));
  std::sort(covariance.point3D_ids.begin(), covariance.point3D_ids.end());
  const auto num_points = static_cast<Eigen::Index>(fit.points.size());
  covariance.blocks.assign(fit.points.size() / kNumCorners, Eigen::MatrixXd::Zero(12, 12));
  covariance.factor = shared_sigma_m * Eigen::Matrix3d::Identity().replicate(num_points, 1);
  covariance.signs = Eigen::VectorXd::Ones(3);
  return covariance;
}

TEST(SurfaceSigma, HoldsWhatTheMarkersShareAndWhatTheResidualsShow) {
  const FittedSurface fit = FitSurface(NoisySail());
  const auto [least_m, largest_m] = [&] {
    double least = 1.0, largest = 0.0;
    for (double place = 0.02; place < 1; place += 0.04) {
      for (double other = 0.02; other < 1; other += 0.04) {
        least = std::min(least, *SigmaAt(fit, place, other));
        largest = std::max(largest, *SigmaAt(fit, place, other));
      }
    }
    return std::make_pair(least, largest);
  }();
  const PointCovariance none = SharedBy(fit, 0.0), shared = SharedBy(fit, 0.05);
  const double by_residuals_m = RmsSigma(fit, &none).value();
  EXPECT_GT(by_residuals_m, least_m);
  EXPECT_LT(by_residuals_m, largest_m);
  const double shared_m = RmsSigma(fit, &shared).value();
  EXPECT_GE(shared_m, 0.05 * (1 - 1e-6));
  EXPECT_LT(shared_m, std::hypot(0.05, largest_m));
}

TEST(SurfaceSigma, IsUnknownWithoutACornerOrForAnInterpolatingSurface) {
  const FittedSurface fit = FitSurface(NoisySail());
  PointCovariance covariance = SharedBy(fit, 0.01);
  EXPECT_FALSE(RmsSigma(FitSurface(AsExact(NoisySail())), &covariance).has_value());
  covariance.point3D_ids.back() += 10000;
  EXPECT_FALSE(RmsSigma(fit, &covariance).has_value());
  EXPECT_FALSE(RmsSigma(fit, nullptr).has_value());
}

}  // namespace
}  // namespace velamap
