#include "reconstruct/sizes/marker_curvature.h"

#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kSide_m = 0.1;

// From places along a surface, m, to the world.
using Sheet = std::function<Eigen::Vector3d(double u, double v)>;

// Squares of 0.1 m along the surface in a grid of 5 x 5 with gaps of half a side.
MarkerState MarkersOn(const Sheet& sheet, double noise_m = 0.0) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  MarkerState state;
  for (int i = 0; i < 25; ++i) {
    MarkerBlock marker;
    marker.marker_id = i;
    marker.part = "sail";
    marker.corners = {1, 2, 3, 4};
    marker.length_m = kSide_m;
    const double u = 1.5 * kSide_m * (i % 5 - 2), v = 1.5 * kSide_m * (i / 5 - 2);
    int slot = 0;
    for (const auto& [right, up] : {std::pair{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}) {
      const Eigen::Vector3d x = sheet(u + 0.5 * kSide_m * right, v + 0.5 * kSide_m * up);
      for (int k = 0; k < 3; ++k) {
        marker.x_in_world[static_cast<std::size_t>(3 * slot + k)] = x[k] + noise_m * normal(random);
      }
      ++slot;
    }
    state.markers.push_back(std::move(marker));
  }
  return state;
}

Sheet Cylinder(double radius_m) {
  return [=](double u, double v) {
    return Eigen::Vector3d(radius_m * std::sin(u / radius_m), v, radius_m * std::cos(u / radius_m));
  };
}

double Chord(double radius_m) {
  return 2 * radius_m / kSide_m * std::sin(0.5 * kSide_m / radius_m);
}

TEST(MarkerCurvature, SidesAroundACylinderAreChords) {
  constexpr double kRadius_m = 0.4;
  for (const double noise_m : {0.0, 2e-4}) {
    MarkerState state = MarkersOn(Cylinder(kRadius_m), noise_m);
    const ChordSummary summary = SetChords(&state);
    for (const MarkerBlock& marker : state.markers) {
      EXPECT_NEAR(marker.chords.side_ratios[0], Chord(kRadius_m), 3e-4) << marker.marker_id;
      EXPECT_NEAR(marker.chords.side_ratios[2], Chord(kRadius_m), 3e-4) << marker.marker_id;
      EXPECT_NEAR(marker.chords.side_ratios[1], 1, 5e-5) << marker.marker_id;
      EXPECT_NEAR(marker.chords.side_ratios[3], 1, 5e-5) << marker.marker_id;
    }
    EXPECT_NEAR(summary.mean_shortening, 0.5 * (1 - Chord(kRadius_m)), 1e-4);
  }
}

// As on a buoy: neighbours are 45 degrees apart.
TEST(MarkerCurvature, FewMarkersAroundACylinderShowItsCurvature) {
  const double radius_m = 1.5 * kSide_m / (45.0 * kRadPerDeg);
  MarkerState state = MarkersOn(Cylinder(radius_m), 2e-4);
  SetChords(&state);
  for (const MarkerBlock& marker : state.markers) {
    EXPECT_NEAR(marker.chords.side_ratios[0], Chord(radius_m), 3e-4) << marker.marker_id;
    EXPECT_NEAR(marker.chords.side_ratios[1], 1, 1e-4) << marker.marker_id;
  }
}

TEST(MarkerCurvature, DiagonalsAroundACylinderAreChords) {
  const Sheet cylinder = Cylinder(0.4);
  MarkerState state = MarkersOn([&](double u, double v) {
    const Eigen::Vector2d turned = Eigen::Rotation2Dd(0.6) * Eigen::Vector2d(u, v);
    return cylinder(turned.x(), turned.y());
  });
  SetChords(&state);
  for (const MarkerBlock& marker : state.markers) {
    const double from1_to3 = (CornerPosition(marker, 2) - CornerPosition(marker, 0)).norm();
    const double from2_to4 = (CornerPosition(marker, 3) - CornerPosition(marker, 1)).norm();
    EXPECT_NEAR(marker.chords.diagonals_difference, (from1_to3 - from2_to4) / kSide_m, 3e-4);
    EXPECT_GT(std::abs(marker.chords.diagonals_difference), 2e-3);
  }
}

TEST(MarkerCurvature, CornersOfFlatMarkersWithNoiseStayAsPrinted) {
  MarkerState state = MarkersOn([](double u, double v) { return Eigen::Vector3d(u, v, 0); }, 3e-4);
  EXPECT_LT(SetChords(&state).largest_shortening, 2e-6);
}

// The curvature is that of the faces, not that of the edge between them.
TEST(MarkerCurvature, TwoWallsAreFlat) {
  for (const double angle_deg : {20.0, 45.0, 90.0}) {
    const double angle = angle_deg * kRadPerDeg;
    // The edge is between the second column and the third.
    MarkerState state = MarkersOn([=](double u, double v) {
      const double beyond_m = u + 0.75 * kSide_m;
      return beyond_m < 0
                 ? Eigen::Vector3d(beyond_m, v, 0)
                 : Eigen::Vector3d(beyond_m * std::cos(angle), v, beyond_m * std::sin(angle));
    });
    EXPECT_LT(SetChords(&state).mean_shortening, 1e-4) << angle_deg;
  }
}

TEST(MarkerCurvature, RigidPartsAndMarkersAloneStayAsPrinted) {
  MarkerState state = MarkersOn(Cylinder(0.4));
  for (MarkerBlock& marker : state.markers) marker.is_rigid = true;
  EXPECT_EQ(SetChords(&state).mean_shortening, 0);
  state.markers.resize(1);
  state.markers[0].is_rigid = false;
  EXPECT_EQ(SetChords(&state).mean_shortening, 0);
  EXPECT_EQ(state.markers[0].chords.side_ratios[0], 1);
}

}  // namespace
}  // namespace velamap
