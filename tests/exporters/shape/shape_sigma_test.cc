#include "exporters/shape/shape_sigma.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "exporters/scale/metric_shape.h"
#include "exporters/shape/adjacent_distances.h"
#include "exporters/shape/part_planes.h"
#include "exporters/shape/shape_metrics.h"
#include "reconstruct/model/gauge.h"
#include "tests/exporters/example_covariance.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

// Moves corners by up to 3 mm, so that no angle is right and no marker flat.
MarkerShape CrookedShape() {
  Model model = ExampleModel();
  std::mt19937 random(9);
  for (auto& [id, point] : model.points3D) {
    for (double& x : point.x_in_world) x += 6e-3 * (random() / 4294967295.0 - 0.5);
  }
  return ShapeFromModel(model, ExampleLayout());
}

// Compares the gradient with central differences of the function.
void ExpectGradient(const MarkerShape& shape, const PointGradient& gradient,
                    const std::function<double(const MarkerShape&)>& function) {
  constexpr double kStep_m = 1e-6;
  for (std::size_t m = 0; m < shape.markers.size(); ++m) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      Eigen::Vector3d expected;
      for (int axis = 0; axis < 3; ++axis) {
        double values[2];
        for (const int sign : {0, 1}) {
          MarkerShape moved = shape;
          const double step_m = sign == 0 ? -kStep_m : kStep_m;
          (*moved.markers[m].x_in_shape_m[corner])[axis] += step_m;
          (*moved.markers[m].x_in_shape_m[0])[axis] += step_m / kNumCorners;
          values[sign] = function(moved);
        }
        expected[axis] = (values[1] - values[0]) / (2 * kStep_m);
      }
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const auto& [id, value] : gradient) {
        if (id == Point3DIdFromCorner({shape.markers[m].marker_id, corner})) sum += value;
      }
      EXPECT_LT((sum - expected).norm(), 1e-7) << shape.markers[m].marker_id << "." << corner;
    }
  }
}

TEST(ShapeSigma, GradientsAreThoseOfTheFunctions) {
  const MarkerShape shape = CrookedShape();
  const auto marker = [](const MarkerShape& s) -> const ShapeMarker& { return s.markers[1]; };
  for (int side = 1; side <= kNumCorners; ++side) {
    ExpectGradient(shape, SideGradient(marker(shape), side),
                   [&](const MarkerShape& s) { return MarkerSides(marker(s))[side - 1]; });
  }
  ExpectGradient(shape, MeanSideGradient(marker(shape)), [&](const MarkerShape& s) {
    const auto sides = MarkerSides(marker(s));
    return (sides[0] + sides[1] + sides[2] + sides[3]) / 4;
  });
  ExpectGradient(shape, AreaGradient(marker(shape)),
                 [&](const MarkerShape& s) { return MarkerArea(marker(s)); });
  for (const int corner1 : {0, 3}) {
    for (const int corner2 : {0, 1}) {
      ExpectGradient(
          shape, DistanceGradient(marker(shape), corner1, shape.markers[6], corner2),
          [&](const MarkerShape& s) {
            return (*marker(s).x_in_shape_m[corner1] - *s.markers[6].x_in_shape_m[corner2]).norm();
          });
    }
  }
}

TEST(ShapeSigma, AnEvenMoveOfAllPointsIsNoUncertaintyOfLengths) {
  const Model model = ExampleModel();
  PointCovariance covariance = ExampleCovariance(model, 1e-3, 1);
  for (Eigen::MatrixXd& block : covariance.blocks) block.setZero();
  covariance.signs = Eigen::Vector3d::Ones();
  for (int axis = 0; axis < 3; ++axis) {
    for (int row = 0; row < covariance.factor.rows(); ++row) {
      covariance.factor(row, axis) = row % 3 == axis ? 0.1 : 0.0;
    }
  }
  const MarkerShape shape = ShapeFromModel(model, ExampleLayout(), &covariance);
  EXPECT_NEAR(shape.markers[0].sigma_m[0]->x(), 0.1, 1e-12);
  EXPECT_LT(*SigmaOf(&covariance, DistanceGradient(shape.markers[0], 0, shape.markers[5], 2)),
            1e-9);
  EXPECT_LT(*SigmaOf(&covariance, AreaGradient(shape.markers[0])), 1e-9);
}

// The covariance of the same points in a rotated frame.
PointCovariance Turned(const Eigen::Matrix3d& rotation, PointCovariance covariance) {
  const auto turn_rows = [&](Eigen::MatrixXd* matrix) {
    for (Eigen::Index row = 0; row < matrix->rows(); row += 3) {
      matrix->middleRows<3>(row) = (rotation * matrix->middleRows<3>(row)).eval();
    }
  };
  turn_rows(&covariance.factor);
  for (Eigen::MatrixXd& block : covariance.blocks) {
    turn_rows(&block);
    block.transposeInPlace();
    turn_rows(&block);
  }
  return covariance;
}

TEST(ShapeSigma, AFrameChangesNoSigmaOfALengthOrAnArea) {
  Model model = ExampleModel();
  const PointCovariance covariance = ExampleCovariance(model, 1e-4, 7);
  const MarkerShape shape = ShapeFromModel(model, ExampleLayout(), &covariance);
  TransformModel(ExampleSim3(1.0), &model);
  const PointCovariance turned = Turned(ExampleSim3(1.0).rotation.toRotationMatrix(), covariance);
  const MarkerShape moved = ShapeFromModel(model, ExampleLayout(), &turned);
  EXPECT_GT((*moved.markers[0].sigma_m[1] - *shape.markers[0].sigma_m[1]).norm(), 1e-6);
  const ShapeMetrics expected = ComputeShapeMetrics(shape, ExampleLayout(), &covariance);
  const ShapeMetrics metrics = ComputeShapeMetrics(moved, ExampleLayout(), &turned);
  EXPECT_NEAR(*metrics.area_sigma_mm2 / *expected.area_sigma_mm2, 1.0, 1e-9);
  EXPECT_NEAR(*metrics.side_sigma_mm / *expected.side_sigma_mm, 1.0, 1e-9);
  const auto pairs = ComparePlanes(FitPartPlanes(moved, &turned), &turned);
  const auto expected_pairs = ComparePlanes(FitPartPlanes(shape, &covariance), &covariance);
  EXPECT_NEAR(*pairs[0].distance_sigma_mm / *expected_pairs[0].distance_sigma_mm, 1.0, 1e-6);
  const auto distances = CompareAdjacentDistances(moved, moved, ExampleLayout(), &turned);
  const auto expected_distances =
      CompareAdjacentDistances(shape, shape, ExampleLayout(), &covariance);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    EXPECT_NEAR(*distances[i].sigma_m / *expected_distances[i].sigma_m, 1.0, 1e-9);
  }
}

// A common scale with a sigma of 1 % gives lengths a sigma of 1 % and areas 2 %.
TEST(ShapeSigma, AnUncertainScaleIsInEveryLength) {
  const Model model = ExampleModel();
  PointCovariance covariance = ExampleCovariance(model, 1e-3, 1);
  for (Eigen::MatrixXd& block : covariance.blocks) block.setZero();
  covariance.factor.resize(covariance.factor.rows(), 1);
  covariance.signs.setOnes(1);
  for (std::size_t i = 0; i < covariance.point3D_ids.size(); ++i) {
    covariance.factor.middleRows<3>(3 * static_cast<int>(i)) =
        0.01 * model.points3D.at(covariance.point3D_ids[i]).x_in_world;
  }
  const MarkerShape shape = ShapeFromModel(model, ExampleLayout(), &covariance);
  const ShapeMetrics metrics = ComputeShapeMetrics(shape, ExampleLayout(), &covariance);
  EXPECT_NEAR(*metrics.markers[0].mean_side_sigma_mm, 1.0, 1e-9);  // of 100 mm
  EXPECT_NEAR(*metrics.markers[7].mean_side_sigma_mm, 0.5, 1e-9);  // of 50 mm
  EXPECT_NEAR(*metrics.markers[7].area_sigma_mm2, 0.02 * 2500, 1e-6);
  EXPECT_NEAR(*metrics.side_sigma_mm, std::sqrt((7 * 1.0 + 0.25) / 8), 1e-9);
  for (const AdjacentDistance& pair :
       CompareAdjacentDistances(shape, shape, ExampleLayout(), &covariance)) {
    EXPECT_NEAR(*pair.sigma_m, 0.01 * pair.distance_m, 1e-12);
  }
}

TEST(ShapeSigma, IsTheStandardDeviationOfWhatIsReported) {
  const PointCovariance covariance = ExampleCovariance(ExampleModel(), 1e-4, 3);
  const MarkerShape shape = ShapeFromModel(ExampleModel(), ExampleLayout(), &covariance);
  const ShapeMetrics metrics = ComputeShapeMetrics(shape, ExampleLayout(), &covariance);
  const auto expect = [&](double sigma, const std::function<double(const MarkerShape&)>& figure) {
    const double sampled = SampledSigma(shape, covariance, figure);
    EXPECT_NEAR(sigma / sampled, 1.0, 0.06);
  };
  expect(*metrics.markers[4].area_sigma_mm2,
         [](const MarkerShape& s) { return 1e6 * MarkerArea(s.markers[4]); });
  expect(*metrics.markers[4].mean_side_sigma_mm, [](const MarkerShape& s) {
    return ComputeShapeMetrics(s, ExampleLayout()).markers[4].mean_side_mm;
  });
  expect(shape.markers[2].sigma_m[0]->y(),
         [](const MarkerShape& s) { return s.markers[2].x_in_shape_m[0]->y(); });
  expect(shape.markers[2].sigma_m[3]->z(),
         [](const MarkerShape& s) { return s.markers[2].x_in_shape_m[3]->z(); });
  const auto distances = CompareAdjacentDistances(shape, shape, ExampleLayout(), &covariance);
  expect(*distances[3].sigma_m, [&](const MarkerShape& s) {
    return CompareAdjacentDistances(s, shape, ExampleLayout())[3].distance_m;
  });
}

TEST(ShapeSigma, WhatIsNotKnownIsNotThere) {
  const Model model = ExampleModel();
  PointCovariance covariance = ExampleCovariance(model, 1e-4, 3);
  std::vector<Point3DId> ids = covariance.point3D_ids;
  ids.erase(std::find(ids.begin(), ids.end(), Point3DId{32}));
  covariance = Subset(covariance, ids);
  const MarkerShape shape = ShapeFromModel(model, ExampleLayout(), &covariance);
  EXPECT_TRUE(shape.markers[2].sigma_m[1].has_value());
  EXPECT_FALSE(shape.markers[2].sigma_m[2].has_value());
  EXPECT_FALSE(shape.markers[2].sigma_m[0].has_value());  // it depends on corner 2
  const ShapeMetrics metrics = ComputeShapeMetrics(shape, ExampleLayout(), &covariance);
  EXPECT_FALSE(metrics.markers[2].area_sigma_mm2.has_value());
  EXPECT_TRUE(metrics.markers[3].area_sigma_mm2.has_value());
  EXPECT_FALSE(metrics.area_sigma_mm2.has_value());
  for (const ShapeMarker& marker : ShapeFromModel(model, ExampleLayout()).markers) {
    for (const auto& sigma_m : marker.sigma_m) EXPECT_FALSE(sigma_m.has_value());
  }
  EXPECT_FALSE(ComputeShapeMetrics(shape, ExampleLayout()).side_sigma_mm.has_value());
}

TEST(ShapeSigma, OfAComparisonIsTheRootOfTheMeanVariance) {
  MarkerShape shape = ShapeFromModel(ExampleModel(), ExampleLayout());
  const MarkerShape reference = shape;
  EXPECT_FALSE(ComputeReferenceMetrics(shape, reference).distance_sigma_m.has_value());
  for (ShapeMarker& marker : shape.markers) {
    marker.sigma_m.fill(Eigen::Vector3d(1e-3, 2e-3, marker.marker_id < 5 ? 2e-3 : 0.0));
  }
  // Squares 9 and 5 mm^2, four markers each.
  EXPECT_NEAR(*ComputeReferenceMetrics(shape, reference).distance_sigma_m, std::sqrt(7.0) * 1e-3,
              1e-12);
}

// Mean square over sampled shapes of the compared points after their own alignment.
TEST(ShapeSigma, OfAComparisonIsThatAfterItsOwnAlignments) {
  const MarkerShape shape = CrookedShape();
  const PointCovariance covariance = ExampleCovariance(ExampleModel(), 2e-4, 11);
  MarkerShape part = shape;
  part.markers.resize(3);
  const ReferenceMetrics predicted = ComputeReferenceMetrics(shape, part, &covariance);
  double sum = 0.0, sum_after_scaling = 0.0;
  constexpr int kNumSamples = 2000;
  SampleShapes(shape, covariance, kNumSamples, [&](const MarkerShape& sample) {
    const ReferenceMetrics comparison = ComputeReferenceMetrics(sample, part);
    sum += std::pow(comparison.distance_m.rms, 2);
    sum_after_scaling += std::pow(comparison.distance_after_scaling_m.rms, 2);
  });
  EXPECT_NEAR(*predicted.distance_sigma_m / std::sqrt(sum / kNumSamples), 1.0, 0.03);
  EXPECT_NEAR(
      *predicted.distance_after_scaling_sigma_m / std::sqrt(sum_after_scaling / kNumSamples), 1.0,
      0.03);
  EXPECT_LT(*predicted.distance_after_scaling_sigma_m, *predicted.distance_sigma_m);
}

TEST(ShapeSigma, OfAComparisonNeedsACovarianceOfAllItsPoints) {
  const MarkerShape shape = CrookedShape();
  const PointCovariance covariance =
      Subset(ExampleCovariance(ExampleModel(), 2e-4, 11), {11, 12, 13, 14});
  const ReferenceMetrics comparison = ComputeReferenceMetrics(shape, shape, &covariance);
  EXPECT_FALSE(comparison.distance_sigma_m.has_value());
  EXPECT_FALSE(comparison.distance_after_scaling_sigma_m.has_value());
}

}  // namespace
}  // namespace velamap
