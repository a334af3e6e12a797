#include "workflows/run/summary.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(LeftOutTextTest, CountsReasonsThatDifferInNumbersTogether) {
  EXPECT_EQ(LeftOutText({}), "none");
  EXPECT_EQ(LeftOutText({{"a.jpg", "shares 1 of 3 markers"},
                         {"b.jpg", "no marker found"},
                         {"c.jpg", "shares 0 of 12 markers"}}),
            "3; 2: shares 1 of 3 markers (a.jpg, c.jpg); 1: no marker found (b.jpg)");
}

TEST(LeftOutTextTest, MarkersAreCountedByReasonToo) {
  EXPECT_EQ(MarkersLeftOutText({}), "none");
  EXPECT_EQ(MarkersLeftOutText({{7, 3, "on line h1 it is 3.50 m from marker 6", true},
                                {12, 4, "on line h2 it is 2.10 m from marker 11", true},
                                {90, 1, "seen in 1 registered frames", false}}),
            "3; 2: on line h1 it is 3.50 m from marker 6 (7, 12); 1: seen in 1 registered frames "
            "(90)");
}

TEST(LeftOutTextTest, ShowsTheFirstNamesOnly) {
  EXPECT_EQ(LeftOutText({{"a", "r"}, {"b", "r"}, {"c", "r"}, {"d", "r"}}),
            "4; 4: r (a, b, c, ...)");
}

// A box of 3 x 2 x 1 m, turned: the sides do not depend on the frame.
TEST(BoundingBoxTest, SidesAreThoseOfATurnedBox) {
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  MarkerShape shape;
  for (const double z : {0.0, 1.0}) {
    ShapeMarker marker;
    marker.x_in_shape_m[0] = rotation * Eigen::Vector3d(1.5, 1, z);
    marker.x_in_shape_m[1] = rotation * Eigen::Vector3d(0, 0, z);
    marker.x_in_shape_m[2] = rotation * Eigen::Vector3d(3, 0, z);
    marker.x_in_shape_m[3] = rotation * Eigen::Vector3d(3, 2, z);
    marker.x_in_shape_m[4] = rotation * Eigen::Vector3d(0, 2, z);
    shape.markers.push_back(marker);
  }
  EXPECT_NEAR((BoundingBox(shape) - Eigen::Vector3d(3, 2, 1)).norm(), 0.0, 1e-12);
}

// All directions are principal axes of a cube; its markers know better.
TEST(BoundingBoxTest, CubeHasItsOwnSides) {
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  MarkerShape shape;
  for (const double z : {0.0, 2.0}) {
    ShapeMarker marker;
    const std::array<Eigen::Vector3d, 5> points = {
        Eigen::Vector3d(1, 1, z), Eigen::Vector3d(0, 0, z), Eigen::Vector3d(2, 0, z),
        Eigen::Vector3d(2, 2, z), Eigen::Vector3d(0, 2, z)};
    for (std::size_t i = 0; i < points.size(); ++i) marker.x_in_shape_m[i] = rotation * points[i];
    shape.markers.push_back(marker);
  }
  EXPECT_NEAR((BoundingBox(shape) - Eigen::Vector3d(2, 2, 2)).norm(), 0.0, 1e-12);
}

TEST(BoundingBoxTest, NothingHasNoSize) { EXPECT_EQ(BoundingBox({}), Eigen::Vector3d::Zero()); }

TEST(ShellQuoteTest, QuotesOnlyWhatAShellWouldTakeApart) {
  EXPECT_EQ(ShellQuote("/a/b-c_1.db"), "/a/b-c_1.db");
  EXPECT_EQ(ShellQuote("my photos"), "'my photos'");
  EXPECT_EQ(ShellQuote("it's"), "'it'\\''s'");
  EXPECT_EQ(ShellQuote(""), "''");
}

}  // namespace
}  // namespace velamap
