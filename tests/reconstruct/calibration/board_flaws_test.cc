#include "reconstruct/calibration/board_flaws.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

constexpr double kSigma_m = 2e-5;
constexpr int kMarkersAcross = 6, kMarkersDown = 4;

// A board of 30 mm markers: stretched along x, bent around y by this height, with noise.
Model Board(double stretch, double bend_m, double noise_m, std::mt19937* random) {
  std::normal_distribution<double> normal;
  Model model;
  for (int id = 0; id < kMarkersAcross * kMarkersDown; ++id) {
    const Eigen::Vector2d middle(0.04 * (id % kMarkersAcross), 0.04 * (id / kMarkersAcross));
    const Eigen::Vector2d corners[] = {
        {-0.015, 0.015}, {0.015, 0.015}, {0.015, -0.015}, {-0.015, -0.015}};
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const Eigen::Vector2d x = middle + corners[corner - 1];
      const double u = x.x() / 0.2 - 0.5;
      model.points3D[Point3DIdFromCorner({id, corner})].x_in_world =
          Eigen::Vector3d((1 + stretch) * x.x(), x.y(), 4 * bend_m * u * u) +
          noise_m * Eigen::Vector3d(normal(*random), normal(*random), normal(*random));
    }
  }
  return model;
}

PointCovariance IndependentPoints(const Model& model) {
  PointCovariance covariance;
  for (const auto& [point3D_id, point] : model.points3D) {
    covariance.point3D_ids.push_back(point3D_id);
    if (covariance.point3D_ids.size() % kNumCorners != 0) continue;
    constexpr int kSize = 3 * kNumCorners;
    covariance.blocks.push_back(kSigma_m * kSigma_m * Eigen::MatrixXd::Identity(kSize, kSize));
  }
  covariance.factor.resize(3 * static_cast<Eigen::Index>(model.points3D.size()), 0);
  return covariance;
}

TEST(FindBoardFlaws, AFlatBoardHasNone) {
  std::mt19937 random(1);
  const Model model = Board(0, 0, 0, &random);
  const BoardFlaws flaws = FindBoardFlaws(model, IndependentPoints(model));
  EXPECT_TRUE(flaws.is_flat);
  EXPECT_NEAR(flaws.extent_m, std::hypot(0.23, 0.15), 1e-12);
  EXPECT_NEAR(flaws.bend_m, 0, 1e-9);
  EXPECT_NEAR(flaws.stretch, 0, 1e-12);
  EXPECT_NEAR(flaws.size_scatter, 0, 1e-9);
  EXPECT_NEAR(flaws.bend_sigma_m, kSigma_m, 1e-12);
}

TEST(FindBoardFlaws, BendAndStretchComeBackWithinTheirSigmas) {
  std::mt19937 random(2);
  // By symmetry, the plane through the bent board is level.
  std::vector<double> heights_m;
  for (const auto& [point3D_id, point] : Board(0.003, 0.001, 0, &random).points3D) {
    heights_m.push_back(point.x_in_world.z());
  }
  const double n = static_cast<double>(heights_m.size());
  const double bend_m = ComputeStatistics(heights_m).standard_deviation * std::sqrt((n - 1) / n);
  std::vector<double> sigmas_off;
  for (int draw = 0; draw < 40; ++draw) {
    const Model model = Board(0.003, 0.001, kSigma_m, &random);
    const BoardFlaws flaws = FindBoardFlaws(model, IndependentPoints(model));
    ASSERT_TRUE(flaws.is_flat);
    EXPECT_NEAR(flaws.bend_m, bend_m, 0.02 * bend_m);
    EXPECT_GT(flaws.max_bend_m, flaws.bend_m);
    sigmas_off.push_back((flaws.stretch - std::log(1.003)) / flaws.stretch_sigma);
  }
  double squares = 0;
  for (const double off : sigmas_off) squares += off * off / 40;
  EXPECT_GT(squares, 0.5);
  EXPECT_LT(squares, 1.6);
}

TEST(FindBoardFlaws, AStronglyBentSurfaceIsNoBoard) {
  std::mt19937 random(3);
  const Model model = Board(0, 0.1, 0, &random);
  const BoardFlaws flaws = FindBoardFlaws(model, IndependentPoints(model));
  EXPECT_FALSE(flaws.is_flat);
  EXPECT_EQ(flaws.stretch, 0.0);
}

}  // namespace
}  // namespace velamap
