#include "exporters/shape/known_distances.h"

#include <cmath>

#include <gtest/gtest.h>

#include "exporters/scale/metric_shape.h"
#include "reconstruct/model/gauge.h"
#include "tests/exporters/example_covariance.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

// The hull's markers are 0.3 m apart, 120's sides are 0.1 m.
Layout LayoutWithDistances() {
  Layout layout = ExampleLayout();
  layout.distances = {{120, 0, 121, 0, 0.301, 3e-4, false},
                      {120, 1, 120, 3, 0.1 * std::sqrt(2.0), 1e-4, true},
                      {5, 0, 121, 2, 1.0, 1e-3, false}};
  return layout;
}

TEST(KnownDistances, AreMeasuredInTheShapeInAnyFrame) {
  Model model = ExampleModel();
  TransformModel(ExampleSim3(1.0), &model);
  const auto checked =
      CheckDistances(ShapeFromModel(model, ExampleLayout()), LayoutWithDistances());
  ASSERT_EQ(checked.size(), 3u);
  EXPECT_NEAR(*checked[0].distance_m, 0.3, 1e-12);
  EXPECT_NEAR(*checked[1].distance_m, checked[1].known.length_m, 1e-12);
  EXPECT_EQ(checked[0].DifferenceSigma(), 3e-4);
  EXPECT_FALSE(checked[0].sigma_m.has_value());
}

TEST(KnownDistances, SigmaIsThatOfTheResultAndTheTape) {
  const PointCovariance covariance = ExampleCovariance(ExampleModel(), 1e-4, 6);
  const MarkerShape shape = ShapeFromModel(ExampleModel(), ExampleLayout(), &covariance);
  const auto checked = CheckDistances(shape, LayoutWithDistances(), &covariance);
  const double sampled = SampledSigma(shape, covariance, [](const MarkerShape& sample) {
    return *CheckDistances(sample, LayoutWithDistances())[2].distance_m;
  });
  EXPECT_NEAR(*checked[2].sigma_m / sampled, 1.0, 0.06);
  EXPECT_NEAR(checked[2].DifferenceSigma(), std::hypot(1e-3, *checked[2].sigma_m), 1e-12);
}

TEST(KnownDistances, APointThatIsMissingLeavesTheMeasurementAlone) {
  Model model = ExampleModel();
  model.points3D.erase(Point3DIdFromCorner({120, 2}));  // no centre then, but corners 1 and 3
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    model.points3D.erase(Point3DIdFromCorner({5, corner}));
  }
  const auto checked =
      CheckDistances(ShapeFromModel(model, ExampleLayout()), LayoutWithDistances());
  EXPECT_FALSE(checked[0].distance_m.has_value());
  EXPECT_TRUE(checked[1].distance_m.has_value());
  EXPECT_FALSE(checked[2].distance_m.has_value());
}

}  // namespace
}  // namespace velamap
