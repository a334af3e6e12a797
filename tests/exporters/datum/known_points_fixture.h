// A shape with random markers and known points of it, for the tests of the datum.

#pragma once

#include <random>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/datum/known_points.h"
#include "tests/exporters/example_covariance.h"
#include "tests/exporters/example_model.h"
#include "tests/support/test_seed.h"

namespace velamap {

// Markers in a box of 3 x 2 x 1 m, whose true coordinates in the user's frame are known.
class KnownPoints : public testing::Test {
 protected:
  static constexpr double kSigma_m = 2e-3;

  double Normal() { return std::normal_distribution<double>()(random_); }
  Eigen::Vector3d Noise(double sigma_m) {
    return sigma_m * Eigen::Vector3d(Normal(), Normal(), Normal());
  }
  Rigid3 RandomMotion() {
    const Eigen::Quaterniond rotation(Normal(), Normal(), Normal(), Normal());
    return {rotation.normalized(), 10 * Noise(1)};
  }

  // Ids 1, 2, ...
  void MakeShape(int num_markers) {
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    shape_.markers.clear();
    layout_.known_points.clear();
    for (int id = 1; id <= num_markers; ++id) {
      const Eigen::Vector3d center(3 * uniform(random_), 2 * uniform(random_), uniform(random_));
      shape_.markers.push_back(SquareMarker(id, 0.1, {RandomMotion().rotation, center}));
    }
    known_from_shape_ = RandomMotion();
  }

  Eigen::Vector3d TrueCoordinates(int marker_id, int corner) const {
    return known_from_shape_ *
           FindMarker(shape_, marker_id)->x_in_shape_m[static_cast<std::size_t>(corner)].value();
  }

  // A point with noise; of the axes in `axes` only.
  KnownPoint& Add(int marker_id, int corner, double noise_m, const std::string& axes = "xyz") {
    const Eigen::Vector3d x = TrueCoordinates(marker_id, corner) + Noise(noise_m);
    KnownPoint point{marker_id, corner, {}, kSigma_m, false};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (axes.find(kAxisNames[axis]) != std::string::npos) {
        point.x_m[axis] = x[static_cast<Eigen::Index>(axis)];
      }
    }
    layout_.known_points.push_back(point);
    return layout_.known_points.back();
  }

  void AddCenters(int num_points, double noise_m) {
    for (int id = 1; id <= num_points; ++id) Add(id, 0, noise_m);
  }

  KnownPointFit Fit(const PointCovariance* covariance = nullptr) const {
    return FitKnownPoints(shape_, layout_, covariance);
  }

  void ExpectTheTrueFrame(double tolerance, const std::string& what) const {
    const KnownPointFit fit = Fit();
    ASSERT_TRUE(fit.known_from_shape) << what << ": " << fit.reason;
    for (const ShapeMarker& marker : shape_.markers) {
      const Eigen::Vector3d x = *marker.x_in_shape_m[0];
      EXPECT_LT((*fit.known_from_shape * x - known_from_shape_ * x).norm(), tolerance) << what;
    }
  }

  // A covariance of all corners, with errors that markers share.
  PointCovariance Covariance(double sigma_m) const {
    Model model;
    for (const ShapeMarker& marker : shape_.markers) {
      for (int corner = 1; corner <= kNumCorners; ++corner) {
        model.points3D[Point3DIdFromCorner({marker.marker_id, corner})];
      }
    }
    return ExampleCovariance(model, sigma_m, TestSeed());
  }

  std::mt19937 random_{TestSeed()};
  MarkerShape shape_;
  Layout layout_ = MakeLayout("DICT_4X4_50", 0.1);
  Rigid3 known_from_shape_;
};

}  // namespace velamap
