#include "reconstruct/sizes/bend_evidence.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "reconstruct/geometry/marker_pose.h"

namespace velamap {
namespace {

constexpr double kSide_m = 0.1, kRadius_m = 0.2, kNoise_m = 1e-4;
constexpr int kNumMarkers = 6;

struct Print {
  bool is_stiff = false;
  double width = 1.0;  // of the prints, relative to their height
  double turn_rad = 0.0;
};

// Markers around a cylinder along y, by random noise.
BendEvidence EvidenceOf(const Print& print, std::mt19937* random) {
  std::normal_distribution<double> noise(0, kNoise_m);
  const Eigen::Rotation2Dd surface_from_marker(print.turn_rad);
  const Eigen::Rotation2Dd marker_from_surface = surface_from_marker.inverse();
  MarkerState state;
  MarkerCovariance covariance;
  std::map<int, Eigen::Matrix2d> curvatures_1_m;
  for (int i = 0; i < kNumMarkers; ++i) {
    MarkerBlock marker;
    marker.marker_id = i;
    marker.corners = {1, 2, 3, 4};
    marker.length_m = kSide_m * (1 + 0.02 * i);
    int slot = 0;
    for (Eigen::Vector3d x : CornersInMarker(marker.length_m)) {
      x.x() *= print.width;
      x.head<2>() = surface_from_marker * Eigen::Vector2d(x.head<2>());
      if (!print.is_stiff) {
        const double angle = x.x() / kRadius_m;
        x.x() = kRadius_m * std::sin(angle);
        x.z() = kRadius_m * (std::cos(angle) - 1);
      }
      for (int k = 0; k < 3; ++k) {
        marker.x_in_world[static_cast<std::size_t>(3 * slot + k)] = x[k] + noise(*random);
      }
      ++slot;
    }
    state.markers.push_back(marker);
    covariance.marker_blocks.emplace_back(kNoise_m * kNoise_m * Eigen::MatrixXd::Identity(12, 12));
    covariance.begins.push_back(12 * i);
    const Eigen::Matrix2d on_surface = Eigen::Vector2d(-1 / kRadius_m, 0).asDiagonal();
    curvatures_1_m[i] = marker_from_surface * on_surface * surface_from_marker;
  }
  covariance.begins.push_back(12 * kNumMarkers);
  covariance.factor = RowMajorMatrix::Zero(12 * kNumMarkers, 1);
  MarkerAdjustmentOptions options;
  options.print_tolerance = 0.0;
  return FindBendEvidence(state, covariance, curvatures_1_m, options);
}

TEST(BendEvidence, IsTheShareOfTheCurvatureThatMarkersFollow) {
  std::mt19937 random(1);
  for (const double turn_rad : {0.0, 0.4, 0.785}) {
    const BendEvidence bent = EvidenceOf({false, 1.0, turn_rad}, &random);
    const BendEvidence stiff = EvidenceOf({true, 1.0, turn_rad}, &random);
    EXPECT_NEAR(bent.share, 1, 3 * bent.sigma);
    EXPECT_NEAR(stiff.share, 0, 3 * stiff.sigma);
    EXPECT_LT(bent.sigma, 0.2);
  }
}

TEST(BendEvidence, HasTheSigmaThatItsScatterShows) {
  constexpr int kDraws = 300;
  std::mt19937 random(2);
  // Turned by 45 degrees, bent markers are no wider than high, so an error of the prints' aspect
  // does not matter.
  double squares = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const BendEvidence evidence = EvidenceOf({true, 1.0, 0.7854}, &random);
    squares += std::pow(evidence.share / evidence.sigma, 2);
  }
  EXPECT_NEAR(squares / kDraws, 1, 0.3);
}

// A printer that stretches one direction makes stiff plates look bent.
TEST(BendEvidence, HasASigmaThatHoldsForUnevenPrints) {
  std::mt19937 random(3);
  for (const double width : {0.998, 1.002}) {
    const BendEvidence evidence = EvidenceOf({true, width, 0.0}, &random);
    EXPECT_GT(std::abs(evidence.share), 0.1);
    EXPECT_LT(std::abs(evidence.share), 3 * evidence.sigma);
  }
}

TEST(BendEvidence, OfNoMarkersIsNone) {
  const BendEvidence evidence = FindBendEvidence({}, {}, {}, {});
  EXPECT_EQ(evidence.share, 0);
  EXPECT_TRUE(std::isinf(evidence.sigma));
}

}  // namespace
}  // namespace velamap
