#include "reconstruct/evidence/marker_rows.h"

#include <random>

#include <gmock/gmock.h>
#include <Eigen/Geometry>

#include "tests/support/synthetic_scene.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::IsEmpty;

ShapePoints ShapeOf(const SyntheticScene& scene) {
  return {scene.x_in_world.begin(), scene.x_in_world.end()};
}

SyntheticScene MakeSail(int num_rows, int num_columns) {
  SyntheticSceneOptions options;
  options.num_rows = num_rows;
  options.num_columns = num_columns;
  options.num_frames = 2;
  return MakeSyntheticScene(options);
}

std::vector<std::vector<int>> LinesOf(const std::vector<MarkerLine>& lines) {
  std::vector<std::vector<int>> ids;
  for (const MarkerLine& line : lines) ids.push_back(line.marker_ids);
  return ids;
}

// A marker that stands on a sheet in the plane of x and z, z up, and faces -y.
void Place(int marker_id, double x_m, double z_m, double side_m, double turn_rad,
           ShapePoints* shape) {
  const Eigen::Vector3d center(x_m, 0.0, z_m);
  const Eigen::AngleAxisd turn(turn_rad, Eigen::Vector3d::UnitY());
  const double h = 0.5 * side_m;
  (*shape)[marker_id] = {
      center, center + turn * Eigen::Vector3d(-h, 0, h), center + turn * Eigen::Vector3d(h, 0, h),
      center + turn * Eigen::Vector3d(h, 0, -h), center + turn * Eigen::Vector3d(-h, 0, -h)};
}

// Lines that become shorter along the right edge, with a vertical line through all of them, and a
// strip below.
ShapePoints TriangularSail(std::uint32_t seed, double noise_m) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0.0, noise_m);
  ShapePoints shape;
  for (int row = 0; row < 5; ++row) {
    for (int i = 0; i < 9 - 2 * row + row / 4; ++i) {
      Place(10 * row + i, 0.15 * i + noise(generator), 1.0 + 0.7 * row + noise(generator), 0.1, 0.0,
            &shape);
    }
    if (row == 4) continue;
    for (int k = 1; k <= 3; ++k) {
      Place(100 + 10 * row + k, 0.15 + noise(generator),
            1.0 + 0.7 * row + 0.175 * k + noise(generator), 0.1, 0.0, &shape);
    }
  }
  for (int i = 0; i < 6; ++i) Place(200 + i, -0.3 + 0.45 * i, 0.35, 0.1, 0.0, &shape);
  return shape;
}

TEST(MarkerRows, TheLinesOfASailComeBack) {
  const SyntheticScene scene = MakeSail(5, 6);
  const std::vector<RowGroup> groups = FindMarkerRows(ShapeOf(scene));
  ASSERT_EQ(groups.size(), 1u);
  const LayoutPart& part = scene.layout.parts.front();
  EXPECT_THAT(groups[0].horizontal, ElementsAreArray(LinesOf(part.horizontal)));
  EXPECT_EQ(groups[0].vertical.size(), 6u);
  EXPECT_THAT(groups[0].others, IsEmpty());
  EXPECT_TRUE(groups[0].knows_up);
  EXPECT_EQ(groups[0].MarkerIds().size(), 30u);
}

TEST(MarkerRows, UnevenPlacesChangeNothing) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const std::vector<RowGroup> groups = FindMarkerRows(TriangularSail(seed, 0.01));
    ASSERT_EQ(groups.size(), 2u) << seed;
    EXPECT_THAT(
        groups[0].horizontal,
        ElementsAre(ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8), ElementsAre(10, 11, 12, 13, 14, 15, 16),
                    ElementsAre(20, 21, 22, 23, 24), ElementsAre(30, 31, 32), ElementsAre(40, 41)))
        << seed;
    EXPECT_THAT(groups[0].vertical, ElementsAre(ElementsAre(1, 101, 102, 103, 11, 111, 112, 113, 21,
                                                            121, 122, 123, 31, 131, 132, 133, 41)))
        << seed;
    EXPECT_LT(groups[0].left_slant, groups[0].right_slant - 0.1) << seed;
    EXPECT_THAT(groups[1].horizontal, ElementsAre(ElementsAre(200, 201, 202, 203, 204, 205)));
  }
}

TEST(MarkerRows, GapsAreBridged) {
  ShapePoints shape = TriangularSail(1, 0.0);
  for (const int id : {4, 5, 13, 102, 121}) shape.erase(id);
  const std::vector<RowGroup> groups = FindMarkerRows(shape);
  EXPECT_THAT(groups[0].horizontal[0], ElementsAre(0, 1, 2, 3, 6, 7, 8));
  EXPECT_THAT(groups[0].horizontal[1], ElementsAre(10, 11, 12, 14, 15, 16));
  EXPECT_EQ(groups[0].vertical.size(), 1u);
  EXPECT_THAT(groups[0].others, IsEmpty());
}

TEST(MarkerRows, ARowDoesNotTurnToAnotherOneWhereItsMarkerIsMissing) {
  ShapePoints shape = TriangularSail(1, 0.0);
  for (const int id : {20, 21, 22, 23, 24, 121, 122, 123, 31, 131, 132, 133, 41}) shape.erase(id);
  // The next line, without its marker above 113.
  int marker_id = 20;
  for (const int column : {-3, -2, -1, 1, 2, 3}) {
    Place(marker_id++, 0.15 + 0.134 * column, 2.434, 0.1, 0.0, &shape);
  }
  const std::vector<RowGroup> groups = FindMarkerRows(shape);
  ASSERT_FALSE(groups.empty());
  EXPECT_THAT(groups[0].vertical, ElementsAre(ElementsAre(1, 101, 102, 103, 11, 111, 112, 113)));
}

TEST(MarkerRows, ItDoesNotMatterHowTheShapeStands) {
  const ShapePoints shape = TriangularSail(1, 0.0);
  ShapePoints moved;
  const Rigid3 motion{Eigen::Quaterniond(0.3, -0.7, 0.2, 0.5).normalized(), {3, -2, 7}};
  for (const auto& [id, points] : shape) moved[id] = Transform(motion, points);
  EXPECT_EQ(FindMarkerRows(moved)[0].horizontal, FindMarkerRows(shape)[0].horizontal);
  EXPECT_EQ(FindMarkerRows(moved)[0].vertical, FindMarkerRows(shape)[0].vertical);
}

TEST(MarkerRows, MarkersThatAreStuckTurnedDoNotSayWhatIsUp) {
  ShapePoints shape;
  for (int row = 0; row < 3; ++row) {
    for (int i = 0; i < 6; ++i) {
      Place(10 * row + i, 0.15 * i, 0.25 * row, 0.08, 1.5708 * ((i + row) % 4), &shape);
    }
  }
  const std::vector<RowGroup> groups = FindMarkerRows(shape);
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_FALSE(groups[0].knows_up);
  EXPECT_EQ(groups[0].horizontal.size(), 3u);
  for (const std::vector<int>& row : groups[0].horizontal) EXPECT_EQ(row.size(), 6u);
}

TEST(MarkerRows, FacesOfACubeAreGroupsOfTheirOwn) {
  SyntheticSceneOptions options;
  options.kind = SceneKind::kCube;
  options.num_rows = options.num_columns = 3;
  options.num_frames = 2;
  const std::vector<RowGroup> groups = FindMarkerRows(ShapeOf(MakeSyntheticScene(options)));
  EXPECT_EQ(groups.size(), 6u);
  for (const RowGroup& group : groups) {
    EXPECT_EQ(group.horizontal.size(), 3u);
    EXPECT_EQ(group.vertical.size(), 3u);
  }
}

TEST(MarkerRows, OneMarkerIsAGroup) {
  ShapePoints shape;
  Place(7, 0.0, 0.0, 0.1, 0.0, &shape);
  const std::vector<RowGroup> groups = FindMarkerRows(shape);
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_THAT(groups[0].others, ElementsAre(7));
}

}  // namespace
}  // namespace velamap
