#include "exporters/scale/metric_scale.h"

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "reconstruct/model/gauge.h"
#include "tests/exporters/example_model.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

// Enlarges a marker about its first corner, like a misdetection.
void ResizeMarker(int marker_id, double factor, Model* model) {
  const Eigen::Vector3d x1 = model->points3D.at(Point3DIdFromCorner({marker_id, 1})).x_in_world;
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    Eigen::Vector3d& x = model->points3D.at(Point3DIdFromCorner({marker_id, corner})).x_in_world;
    x = x1 + factor * (x - x1);
  }
}

TEST(MetricScale, AnySimilarityIsUndone) {
  const Layout layout = ExampleLayout();
  for (const double scale : {1.0, 1e-4, 0.137, 73.0, 1e5}) {
    Model model = ExampleModel();
    TransformModel(ExampleSim3(scale), &model);
    const ScaleEstimate estimate = EstimateScale(model, layout);
    EXPECT_NEAR(estimate.m_per_unit * scale, 1.0, 1e-12) << scale;
    EXPECT_LT(estimate.relative_spread, 1e-11) << scale;
    EXPECT_EQ(estimate.num_markers, 8) << scale;
  }
}

TEST(MetricScale, EveryMarkerIsJudgedByItsOwnLength) {
  const ScaleEstimate estimate = EstimateScale(ExampleModel(), ExampleLayout());
  ASSERT_EQ(estimate.m_per_unit_of.size(), 8u);
  EXPECT_NEAR(estimate.m_per_unit_of.at(120), 1.0, 1e-12);
  EXPECT_NEAR(estimate.m_per_unit_of.at(121), 1.0, 1e-12);  // the one of 50 mm
}

TEST(MetricScale, AnOutlierMovesNothingAndIsListed) {
  for (const double factor : {0.2, 0.9, 1.01, 50.0}) {
    Model model = ExampleModel();
    ResizeMarker(3, factor, &model);
    const ScaleEstimate estimate = EstimateScale(model, ExampleLayout());
    EXPECT_NEAR(estimate.m_per_unit, 1.0, 1e-12) << factor;
    EXPECT_EQ(estimate.num_markers, 7) << factor;
    EXPECT_NEAR(estimate.m_per_unit_of.at(3), 1.0 / factor, 1e-9) << factor;
  }
}

TEST(MetricScale, OfTheThesisIsPrintedSideOverTheMeanOfAllSides) {
  Model model = ExampleModel();
  ResizeMarker(3, 1.5, &model);
  // Seven markers of 100 mm, one of them measured as 150 mm, and one of 50 mm.
  const ScaleEstimate estimate = EstimateScale(model, ExampleLayout(), ScaleMethod::kMeanSide);
  EXPECT_NEAR(estimate.m_per_unit, 0.75 / 0.80, 1e-12);
  EXPECT_EQ(estimate.num_markers, 8);
}

TEST(MetricScale, IsTheMeanOfWhatAgreesWithARobustSpread) {
  Model model = ExampleModel();
  for (const int marker_id : {4, 5, 6, 120, 121}) {
    model.points3D.erase(Point3DIdFromCorner({marker_id, 2}));
  }
  ResizeMarker(1, 1 / 0.99, &model);
  ResizeMarker(3, 1 / 1.02, &model);
  const ScaleEstimate estimate = EstimateScale(model, ExampleLayout());
  EXPECT_EQ(estimate.num_markers, 3);
  const double mean = (0.99 + 1.0 + 1.02) / 3;
  EXPECT_NEAR(estimate.m_per_unit, mean, 1e-12);
  EXPECT_NEAR(estimate.relative_spread, 1.4826 * 0.01 / mean, 1e-12);
}

TEST(MetricScale, OneWholeMarkerIsEnough) {
  Model model = ExampleModel();
  for (const int marker_id : {1, 2, 3, 4, 5, 6, 120}) {
    model.points3D.erase(Point3DIdFromCorner({marker_id, 4}));
  }
  const ScaleEstimate estimate = EstimateScale(model, ExampleLayout());
  EXPECT_NEAR(estimate.m_per_unit, 1.0, 1e-12);
  EXPECT_EQ(estimate.num_markers, 1);
  EXPECT_EQ(estimate.relative_spread, 0.0);
}

TEST(MetricScale, AMarkerInOnePointGivesNoScale) {
  Model model = ExampleModel();
  ResizeMarker(2, 0.0, &model);
  const ScaleEstimate estimate = EstimateScale(model, ExampleLayout());
  EXPECT_NEAR(estimate.m_per_unit, 1.0, 1e-12);
  EXPECT_EQ(estimate.m_per_unit_of.count(2), 0u);
}

TEST(MetricScale, WithoutAWholeMarkerTheReasonIsGiven) {
  Model model;
  for (const Point3DId id : {11, 12, 13, 27}) model.points3D[id] = {};
  ExpectThrows<DataError>(
      [&] { EstimateScale(model, ExampleLayout()); },
      {"no marker of the model has all four corners", "4 points, 3 of them marker corners"});
}

TEST(MetricScale, PointsWithForeignIdsAreExplained) {
  Model model;
  for (const Point3DId id : {15, 16, 17, 18}) model.points3D[id] = {};
  ExpectThrows<DataError>([&] { EstimateScale(model, ExampleLayout()); },
                          {"10 * marker id + corner"});
}

TEST(MetricScale, SigmaIsTheStandardErrorOfTheMean) {
  Model model = ExampleModel();
  for (const int marker_id : {5, 6, 120, 121}) {
    model.points3D.erase(Point3DIdFromCorner({marker_id, 2}));
  }
  ResizeMarker(1, 1 / 0.99, &model);
  ResizeMarker(3, 1 / 1.02, &model);
  ResizeMarker(4, 1 / 1.01, &model);
  const ScaleEstimate estimate = EstimateScale(model, ExampleLayout());
  const Statistics ratios = ComputeStatistics({0.99, 1.0, 1.02, 1.01});
  EXPECT_EQ(estimate.num_markers, 4);
  EXPECT_NEAR(*estimate.relative_sigma, ratios.standard_deviation / 2 / ratios.mean, 1e-9);
  for (const int marker_id : {1, 2, 3}) {
    model.points3D.erase(Point3DIdFromCorner({marker_id, 2}));
  }
  EXPECT_FALSE(EstimateScale(model, ExampleLayout()).relative_sigma.has_value());
}

TEST(MetricScale, OfAMetricModelIsOneWithTheSigmaOfItsAdjustment) {
  AdjustmentUncertainty uncertainty;
  uncertainty.relative_scale_sigma = 2e-4;
  const ScaleEstimate estimate =
      MetricScale({{1, 1.001}, {2, 0.999}, {3, 1.0}, {4, 1.5}}, uncertainty);
  EXPECT_EQ(estimate.m_per_unit, 1.0);
  EXPECT_EQ(*estimate.relative_sigma, 2e-4);
  EXPECT_EQ(estimate.num_markers, 3);
  EXPECT_NEAR(estimate.relative_spread, 1.4826e-3, 1e-9);
  EXPECT_EQ(MetricScale({}, uncertainty).m_per_unit, 1.0);
}

}  // namespace
}  // namespace velamap
