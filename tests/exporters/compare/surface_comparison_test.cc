#include "exporters/compare/surface_comparison.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/compare/shape_deviation.h"
#include "exporters/comparison_page/comparison_ply.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/exporters/formats/ply_reader.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const ShapeSurfaces& BoatSurfaces() {
  static const ShapeSurfaces surfaces(BoatShape());
  return surfaces;
}

TEST(ComparisonSurface, AShapeIsNowhereFromItself) {
  const SurfaceComparison comparison =
      CompareSurfaces(BoatSurfaces(), BoatSurfaces(), BoatLayout());
  ASSERT_EQ(comparison.parts.size(), 1u);
  EXPECT_EQ(comparison.parts[0].part, "sail");
  EXPECT_EQ(comparison.parts[0].statistics_m.count,
            static_cast<int>(comparison.parts[0].mesh.vertices_m.size()));
  EXPECT_LT(LargestDistance(comparison), 1e-9);
}

// The surface follows the sigmas of the markers, which an alignment has to keep.
TEST(ComparisonSurface, AnUncertainShapeIsNowhereFromItselfElsewhere) {
  MarkerShape shape = BoatShape(0.001);
  double wave = 0.0;
  for (ShapeMarker& marker : shape.markers) {
    double error_m = 0.0;
    for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
      error_m = 0.01 * std::sin(wave += 1.7);
      *marker.x_in_shape_m[corner] += Eigen::Vector3d(0, error_m, 0);
    }
    marker.x_in_shape_m[0] = MeanOfCorners(marker);
    for (auto& sigma_m : marker.sigma_m) *sigma_m = {0.001, 0.002 + 0.3 * std::abs(error_m), 0.004};
  }
  const ShapeDeviation deviation =
      CompareWithShape({Moved(FarPose(), shape), {}}, {shape, {}}, BoatLayout(), {}, "");
  const ShapeSurfaces reference(shape);
  EXPECT_LT(LargestDistance(
                CompareSurfaces(ShapeSurfaces(deviation.aligned_shape), reference, BoatLayout())),
            1e-9);
  MarkerShape certain = shape;
  for (ShapeMarker& marker : certain.markers) marker.sigma_m = {};
  EXPECT_GT(LargestDistance(CompareSurfaces(ShapeSurfaces(certain), reference, BoatLayout())),
            1e-4);
}

TEST(ComparisonSurface, IsFittedAgainOnlyToOtherMarkersOfItsPart) {
  const Layout layout = BoatLayout();
  const LayoutPart& sail = *FirstPartWithLines(layout);
  const std::set<int> of_sail = MarkerIds(sail);
  const auto without = [](int marker_id) {
    MarkerShape shape = BoatShape();
    shape.markers.erase(
        std::find_if(shape.markers.begin(), shape.markers.end(),
                     [=](const ShapeMarker& marker) { return marker.marker_id == marker_id; }));
    return shape;
  };
  int of_hull = 0;
  for (const ShapeMarker& marker : BoatShape().markers) {
    if (of_sail.count(marker.marker_id) == 0) of_hull = marker.marker_id;
  }
  const ShapeSurfaces& surfaces = BoatSurfaces();
  EXPECT_EQ(&surfaces.OfCommon(sail, without(of_hull)), &surfaces.Of(sail));
  const FittedSurface& common = surfaces.OfCommon(sail, without(*of_sail.begin()));
  EXPECT_EQ(common.residuals.size() + 1, surfaces.Of(sail).residuals.size());
  const ShapeSurfaces other(without(*of_sail.begin()));
  EXPECT_EQ(common.distance_m.max, other.OfCommon(sail, BoatShape()).distance_m.max);
}

// Moves all lines by 20 mm along the mean normal, and the middle of the sail with them.
TEST(ComparisonSurface, APushedSailIsAsFarOffAllOver) {
  const Eigen::Vector3d push(0.0, 0.02, 0.0);
  const SurfaceComparison comparison = CompareSurfaces(
      ShapeSurfaces(Shifted(IdsOf("sail"), push, BoatShape())), BoatSurfaces(), BoatLayout());
  const SurfaceDeviation& sail = comparison.parts.at(0);
  const double sign = sail.statistics_m.mean > 0 ? 1 : -1;
  EXPECT_NEAR(sail.statistics_m.mean, sign * 0.019, 0.002);  // the sail is not all across y
  EXPECT_LE(sail.statistics_m.max, 0.0201);
  // After a move aft, a strip along the leech lies beside the reference.
  const SurfaceDeviation aft =
      CompareSurfaces(ShapeSurfaces(Shifted(IdsOf("sail"), {0.3, 0, 0}, BoatShape())),
                      BoatSurfaces(), BoatLayout())
          .parts.at(0);
  EXPECT_LT(aft.statistics_m.count, static_cast<int>(0.95 * aft.mesh.vertices_m.size()));
  EXPECT_GT(aft.statistics_m.count, static_cast<int>(0.5 * aft.mesh.vertices_m.size()));
}

TEST(ComparisonSurface, IsPositiveWhereTheMarkersFace) {
  MarkerShape turned = BoatShape();
  for (ShapeMarker& marker : turned.markers) {
    std::swap(marker.x_in_shape_m[1], marker.x_in_shape_m[2]);
    std::swap(marker.x_in_shape_m[4], marker.x_in_shape_m[3]);
  }
  for (const MarkerShape& reference : {BoatShape(), turned}) {
    const Eigen::Vector3d push = 0.02 * MarkerNormal(*FindWholeMarker(reference, 33));
    const SurfaceComparison comparison =
        CompareSurfaces(ShapeSurfaces(Shifted(IdsOf("sail"), push, reference)),
                        ShapeSurfaces(reference), BoatLayout());
    EXPECT_NEAR(comparison.parts.at(0).statistics_m.mean, 0.019, 0.002);
  }
}

TEST(ComparisonSurface, OfADesignIsMeasuredOnItsFaces) {
  const SurfaceComparison comparison =
      CompareSurfaces(BoatSurfaces(), MeshDistance(SailMesh()), BoatLayout());
  ASSERT_EQ(comparison.parts.size(), 1u);
  EXPECT_LT(LargestDistance(comparison), 0.005);  // what a spline through six markers a line leaves
  EXPECT_GT(LargestDistance(comparison), 1e-6);
  EXPECT_THAT(CompareSurfaces(BoatSurfaces(), MeshDistance(SailMesh()), BoatLayout(), "hull").parts,
              IsEmpty());
}

TEST(ComparisonSurface, SaysWhyAPartHasNone) {
  MarkerShape shape = BoatShape();
  shape.markers.erase(shape.markers.begin() + 6, shape.markers.begin() + 30);  // h1 is left
  const SurfaceComparison comparison =
      CompareSurfaces(ShapeSurfaces(shape), BoatSurfaces(), BoatLayout());
  EXPECT_THAT(comparison.parts, IsEmpty());
  EXPECT_THAT(comparison.notes, ElementsAre(HasSubstr("sail: no surface: ")));
}

TEST(ComparisonSurface, PlyHoldsDistanceAndColour) {
  const SurfaceComparison comparison =
      CompareSurfaces(ShapeSurfaces(Shifted(IdsOf("sail"), {0, 0.02, 0}, BoatShape())),
                      BoatSurfaces(), BoatLayout());
  std::ostringstream out;
  WriteComparisonSurfacePly(comparison, 0.01, out);
  EXPECT_THAT(out.str(), HasSubstr("blue -10 mm, white 0, red +10 mm"));
  const SurfaceDeviation& sail = comparison.parts[0];
  const PlyFile ply = ReadPly(out.str());
  ASSERT_EQ(ply.elements[0].rows.size(), sail.mesh.vertices_m.size());
  EXPECT_EQ(ply.elements[1].rows.size(), sail.mesh.triangles.size());
  for (std::size_t i = 0; i < sail.distance_m.size(); ++i) {
    const Eigen::Array3d color = DivergingColor(sail.distance_m[i], 0.01);
    EXPECT_EQ(ply.elements[0].Column("red")[i], color[0]);
    if (!sail.distance_m[i]) continue;
    EXPECT_NEAR(ply.elements[0].Column("distance")[i], *sail.distance_m[i], 1e-8);
  }
}

TEST(DivergingColor, IsWhiteInTheMiddleAndClamps) {
  const auto is = [](const Eigen::Array3d& color, double red, double green, double blue) {
    return color[0] == red && color[1] == green && color[2] == blue;
  };
  EXPECT_TRUE(is(DivergingColor(0.0, 1.0), 247, 247, 247));
  EXPECT_TRUE(is(DivergingColor(5.0, 1.0), 178, 24, 43));
  EXPECT_TRUE(is(DivergingColor(-1.0, 1.0), 33, 102, 172));
  EXPECT_TRUE(is(DivergingColor(0.3, 0.0), 247, 247, 247));
  EXPECT_TRUE(is(DivergingColor(std::nullopt, 1.0), 128, 128, 128));
}

}  // namespace
}  // namespace velamap
