#include "exporters/shape/adjacent_distances.h"

#include <gmock/gmock.h>

#include "exporters/scale/metric_shape.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

MarkerShape ExampleShape() { return ShapeFromModel(ExampleModel(), ExampleLayout()); }

void Move(const Eigen::Vector3d& shift_m, ShapeMarker* marker) {
  for (auto& x : marker->x_in_shape_m) *x += shift_m;
}

std::vector<std::pair<int, int>> PairsOf(const std::vector<AdjacentDistance>& distances) {
  std::vector<std::pair<int, int>> pairs;
  for (const AdjacentDistance& d : distances) pairs.emplace_back(d.marker_id1, d.marker_id2);
  return pairs;
}

TEST(AdjacentDistances, PairsAreThoseOfTheLayoutEachOnce) {
  const auto distances = CompareAdjacentDistances(ExampleShape(), ExampleShape(), ExampleLayout());
  EXPECT_THAT(PairsOf(distances), ElementsAre(std::pair(1, 2), std::pair(2, 3), std::pair(4, 5),
                                              std::pair(5, 6), std::pair(120, 121)));
  for (const AdjacentDistance& d : distances) EXPECT_EQ(d.distance_m, d.reference_distance_m);
  EXPECT_NEAR(distances.back().distance_m, 0.3, 1e-12);                   // as the hull is made
  EXPECT_NEAR(distances.front().distance_m, 4 * std::sin(0.075), 1e-12);  // chord of the cylinder
}

TEST(AdjacentDistances, AMovedMarkerShowsInItsOwnPairsOnly) {
  MarkerShape shape = ExampleShape();
  Move({0.006, 0, 0}, &shape.markers[7]);  // 121, to the right of 120
  const auto distances = CompareAdjacentDistances(shape, ExampleShape(), ExampleLayout());
  for (const AdjacentDistance& d : distances) {
    EXPECT_NEAR(d.distance_m - d.reference_distance_m, d.marker_id2 == 121 ? 0.006 : 0.0, 1e-12);
  }
}

TEST(AdjacentDistances, TheFrameDoesNotMatterAndTheScaleDoes) {
  for (const double scale : {1.0, 1.06}) {
    MarkerShape shape = ExampleShape();
    for (ShapeMarker& marker : shape.markers) {
      for (auto& x : marker.x_in_shape_m) x = ExampleSim3(scale) * *x;
    }
    const auto distances = CompareAdjacentDistances(shape, ExampleShape(), ExampleLayout());
    ASSERT_EQ(distances.size(), 5u);
    for (const AdjacentDistance& d : distances) {
      EXPECT_NEAR(d.distance_m / d.reference_distance_m, scale, 1e-12);
    }
  }
}

TEST(AdjacentDistances, BothMarkersHaveToBeWholeInBothShapes) {
  MarkerShape shape = ExampleShape(), reference = ExampleShape();
  shape.markers[1].x_in_shape_m[0].reset();              // 2
  reference.markers.erase(reference.markers.end() - 1);  // 121
  EXPECT_THAT(PairsOf(CompareAdjacentDistances(shape, reference, ExampleLayout())),
              ElementsAre(std::pair(4, 5), std::pair(5, 6)));
}

TEST(AdjacentDistances, WithoutALayoutNothingIsAdjacent) {
  EXPECT_THAT(
      CompareAdjacentDistances(ExampleShape(), ExampleShape(), MakeLayout("DICT_4X4_250", 0.1)),
      IsEmpty());
}

}  // namespace
}  // namespace velamap
