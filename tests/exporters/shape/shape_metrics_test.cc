#include "exporters/shape/shape_metrics.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "exporters/scale/metric_shape.h"
#include "importer/base/error.h"
#include "tests/exporters/example_model.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

MarkerShape Transformed(const Sim3& b_from_a, MarkerShape shape) {
  for (ShapeMarker& marker : shape.markers) {
    for (auto& x : marker.x_in_shape_m) {
      if (x) x = b_from_a * *x;
    }
  }
  return shape;
}

MarkerShape ExampleShape() { return ShapeFromModel(ExampleModel(), ExampleLayout()); }

TEST(ShapeMetrics, AnExactShapeHasNoError) {
  const ShapeMetrics metrics =
      ComputeShapeMetrics(Transformed(ExampleSim3(1.0), ExampleShape()), ExampleLayout());
  EXPECT_EQ(metrics.num_markers, 8);
  EXPECT_EQ(metrics.area_error_mm2.count, 8);
  EXPECT_EQ(metrics.side_error_mm.count, 32);
  EXPECT_LT(metrics.area_error_mm2.max, 1e-8);
  EXPECT_LT(metrics.area_error_percent.max, 1e-10);
  EXPECT_LT(metrics.side_error_mm.max, 1e-10);
  EXPECT_EQ(metrics.reconstruction_ratio, 1.0);
  EXPECT_THAT(metrics.missing_marker_ids, IsEmpty());
}

TEST(ShapeMetrics, ErrorsAreAgainstThePrintedLengthOfEachMarker) {
  MarkerShape shape;
  shape.markers = {SquareMarker(1, 0.103), SquareMarker(121, 0.049)};  // printed 0.1 and 0.05
  const ShapeMetrics metrics = ComputeShapeMetrics(shape, ExampleLayout());
  EXPECT_NEAR(metrics.area_error_mm2.max, 103.0 * 103.0 - 100.0 * 100.0, 1e-8);
  EXPECT_NEAR(metrics.area_error_mm2.min, 50.0 * 50.0 - 49.0 * 49.0, 1e-8);
  EXPECT_NEAR(metrics.area_error_percent.max, 6.09, 1e-10);
  EXPECT_NEAR(metrics.area_error_percent.min, 3.96, 1e-10);
  EXPECT_NEAR(metrics.side_error_mm.max, 3.0, 1e-10);
  EXPECT_NEAR(metrics.side_error_mm.min, 1.0, 1e-10);
  EXPECT_NEAR(metrics.side_error_mm.mean, 2.0, 1e-10);
}

TEST(ShapeMetrics, MarkersAreListedWithTheirOwnErrors) {
  MarkerShape shape;
  shape.markers = {SquareMarker(1, 0.103), SquareMarker(2, 0.1), SquareMarker(121, 0.049)};
  shape.markers[1].x_in_shape_m[0].reset();  // not whole
  shape.markers[2].part = "hull";
  const auto markers = ComputeShapeMetrics(shape, ExampleLayout()).markers;
  ASSERT_EQ(markers.size(), 2u);
  EXPECT_EQ(markers[0].marker_id, 1);
  EXPECT_NEAR(markers[0].area_error_mm2, 609.0, 1e-8);
  EXPECT_NEAR(markers[0].area_error_percent, 6.09, 1e-10);
  EXPECT_NEAR(markers[0].side_error_mm, 3.0, 1e-10);
  EXPECT_EQ(markers[1].marker_id, 121);
  EXPECT_EQ(markers[1].part, "hull");
  EXPECT_NEAR(markers[1].side_error_mm, 1.0, 1e-10);
}

TEST(ShapeMetrics, OnlyWholeMarkersOfTheLayoutCountForTheRatio) {
  Model model = ExampleModel();
  model.points3D.erase(Point3DIdFromCorner({5, 1}));  // not whole
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    model.points3D.erase(Point3DIdFromCorner({121, corner}));                  // not there
    model.points3D[Point3DIdFromCorner({60, corner})].x_in_world.setRandom();  // not in the layout
  }
  const ShapeMetrics metrics =
      ComputeShapeMetrics(ShapeFromModel(model, ExampleLayout()), ExampleLayout());
  EXPECT_EQ(metrics.num_markers, 7);
  EXPECT_EQ(metrics.num_layout_markers, 8);
  EXPECT_THAT(metrics.other_marker_ids, ElementsAre(60));
  EXPECT_EQ(metrics.NumWholeOfLayout(), 6);
  EXPECT_DOUBLE_EQ(metrics.reconstruction_ratio.value(), 6.0 / 8.0);
  EXPECT_EQ(metrics.num_sail_markers, 6);  // without the hull's two, one of which is missing
  EXPECT_DOUBLE_EQ(metrics.sail_reconstruction_ratio.value(), 5.0 / 6.0);
  EXPECT_THAT(metrics.missing_marker_ids, ElementsAre(5, 121));
}

TEST(ShapeMetrics, WithoutLinesThereIsNoRatioOfTheSail) {
  Layout layout = ExampleLayout();
  layout.parts.erase(layout.parts.begin());
  const ShapeMetrics metrics = ComputeShapeMetrics(ExampleShape(), layout);
  EXPECT_EQ(metrics.reconstruction_ratio, 1.0);
  EXPECT_FALSE(metrics.num_sail_markers);
  EXPECT_FALSE(metrics.sail_reconstruction_ratio);
}

TEST(ShapeMetrics, WithoutAListOfMarkersThereIsNoRatio) {
  const ShapeMetrics metrics = ComputeShapeMetrics(ExampleShape(), MakeLayout("DICT_4X4_250", 0.1));
  EXPECT_EQ(metrics.num_markers, 8);
  EXPECT_FALSE(metrics.num_layout_markers);
  EXPECT_FALSE(metrics.reconstruction_ratio);
  EXPECT_FALSE(metrics.sail_reconstruction_ratio);
  EXPECT_THAT(metrics.missing_marker_ids, IsEmpty());
}

// A scale error that all markers share is invisible to these metrics (workflows/studies/README.md):
// sides that look too short give a wrong scale.
TEST(ShapeMetrics, DoNotSeeMarkersThatAllShrinkBeforeScaling) {
  Model model = ExampleModel();
  for (const ShapeMarker& marker : ExampleShape().markers) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      Eigen::Vector3d& x =
          model.points3D.at(Point3DIdFromCorner({marker.marker_id, corner})).x_in_world;
      x = *marker.x_in_shape_m[0] + 0.95 * (x - *marker.x_in_shape_m[0]);
    }
  }
  ScaleModel(EstimateScale(model, ExampleLayout()), &model);
  const MarkerShape shape = ShapeFromModel(model, ExampleLayout());
  EXPECT_LT(ComputeShapeMetrics(shape, ExampleLayout()).area_error_percent.max, 1e-9);
  EXPECT_GT(ComputeReferenceMetrics(shape, ExampleShape()).scale, 1.04);
}

TEST(ReferenceMetrics, FrameAndScaleAreToldApart) {
  const MarkerShape reference = ExampleShape();
  for (const double scale : {0.9, 1.0, 1.02}) {
    const MarkerShape shape = Transformed(ExampleSim3(scale), reference);
    const ReferenceMetrics comparison = ComputeReferenceMetrics(shape, reference);
    EXPECT_EQ(comparison.num_points, 32);
    EXPECT_NEAR(comparison.scale, scale, 1e-12);
    EXPECT_LT(comparison.distance_after_scaling_m.max, 1e-12);
    if (scale == 1.0) {
      EXPECT_LT(comparison.distance_m.max, 1e-12);
    } else {
      EXPECT_GT(comparison.distance_m.mean, 0.01 * std::abs(scale - 1.0));
    }
  }
}

TEST(ReferenceMetrics, OnlyCornersThatBothHaveAreUsed) {
  const MarkerShape reference = ExampleShape();
  MarkerShape shape = Transformed(ExampleSim3(1.0), reference);
  shape.markers[0].x_in_shape_m[2].reset();                     // a corner gone
  shape.markers[1].x_in_shape_m[0] = Eigen::Vector3d(9, 9, 9);  // a centre is no point
  shape.markers.push_back(SquareMarker(500, 0.1));              // not in the reference
  const ReferenceMetrics comparison = ComputeReferenceMetrics(shape, reference);
  EXPECT_EQ(comparison.num_points, 31);
  EXPECT_LT(comparison.distance_m.max, 1e-12);
}

TEST(ReferenceMetrics, ADisplacedCornerShowsInTheMaximum) {
  const MarkerShape reference = ExampleShape();
  MarkerShape shape = reference;
  *shape.markers[3].x_in_shape_m[4] += Eigen::Vector3d(0, 0, 0.01);
  const ReferenceMetrics comparison = ComputeReferenceMetrics(shape, reference);
  EXPECT_NEAR(comparison.distance_m.max, 0.01, 0.002);
  EXPECT_LT(comparison.distance_m.median, 0.002);
}

TEST(ReferenceMetrics, DistancesOfMarkersAddUpToTheWhole) {
  const MarkerShape reference = ExampleShape();
  MarkerShape shape = Transformed(ExampleSim3(1.01), reference);
  for (auto& x : shape.markers[5].x_in_shape_m) *x += Eigen::Vector3d(0, 0, 0.02);
  shape.markers[2].x_in_shape_m[4].reset();
  const ReferenceMetrics comparison = ComputeReferenceMetrics(shape, reference);
  ASSERT_EQ(comparison.markers.size(), 8u);
  double sum = 0.0, sum_after_scaling = 0.0;
  for (const MarkerDistance& marker : comparison.markers) {
    EXPECT_EQ(marker.num_corners, marker.marker_id == 3 ? 3 : 4);
    sum += marker.num_corners * marker.distance_m;
    sum_after_scaling += marker.num_corners * marker.distance_after_scaling_m;
  }
  EXPECT_NEAR(sum / 31, comparison.distance_m.mean, 1e-12);
  EXPECT_NEAR(sum_after_scaling / 31, comparison.distance_after_scaling_m.mean, 1e-12);
  const auto worst = std::max_element(
      comparison.markers.begin(), comparison.markers.end(), [](const auto& a, const auto& b) {
        return a.distance_after_scaling_m < b.distance_after_scaling_m;
      });
  EXPECT_EQ(worst->marker_id, 6);
}

TEST(ReferenceMetrics, AMirroredShapeDoesNotPass) {
  const MarkerShape reference = ExampleShape();
  MarkerShape shape = reference;
  for (ShapeMarker& marker : shape.markers) {
    for (auto& x : marker.x_in_shape_m) x->x() = -x->x();
  }
  EXPECT_GT(ComputeReferenceMetrics(shape, reference).distance_m.mean, 0.01);
}

TEST(ReferenceMetrics, TooFewCommonCornersAreSaid) {
  MarkerShape shape, reference;
  shape.markers = {SquareMarker(1, 0.1), SquareMarker(2, 0.1)};
  reference.markers = {SquareMarker(2, 0.1), SquareMarker(3, 0.1)};
  EXPECT_EQ(ComputeReferenceMetrics(shape, reference).num_points, 4);
  for (const int corner : {0, 1, 2}) reference.markers[0].x_in_shape_m[corner].reset();
  ExpectThrows<DataError>([&] { ComputeReferenceMetrics(shape, reference); },
                          {"2 marker corners in common; an alignment needs 3"});
}

TEST(ReferenceMetrics, CornersInOnePointAreSaid) {
  MarkerShape shape, reference;
  shape.markers = {SquareMarker(1, 0.0)};
  reference.markers = {SquareMarker(1, 0.1)};
  EXPECT_THROW(ComputeReferenceMetrics(shape, reference), DataError);
  EXPECT_THROW(ComputeReferenceMetrics(reference, shape), DataError);
}

}  // namespace
}  // namespace velamap
