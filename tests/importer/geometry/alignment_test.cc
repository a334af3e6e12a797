#include "importer/geometry/alignment.h"

#include <random>

#include <gtest/gtest.h>

namespace velamap {
namespace {

std::vector<Eigen::Vector3d> RandomPoints(int count, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    points.emplace_back(normal(generator), normal(generator), normal(generator));
  }
  return points;
}

Sim3 SomeTransform() {
  return {2.5, Eigen::Quaterniond(0.8, -0.3, 0.4, 0.33).normalized(), {3, -2, 7}};
}

TEST(Alignment, RigidTransformIsRecovered) {
  const Rigid3 truth{SomeTransform().rotation, SomeTransform().translation};
  for (const int count : {3, 4, 50}) {
    const auto a = RandomPoints(count, 1);
    std::vector<Eigen::Vector3d> b;
    for (const auto& point : a) b.push_back(truth * point);
    const Rigid3 estimate = EstimateRigid3(a, b);
    EXPECT_LT(AngularDistance(estimate, truth), 1e-7);
    EXPECT_LT((estimate.translation - truth.translation).norm(), 1e-12);
    EXPECT_LT((estimate * a[0] - b[0]).norm(), 1e-12);
  }
}

TEST(Alignment, SimilarityIsRecovered) {
  const Sim3 truth = SomeTransform();
  const auto a = RandomPoints(20, 2);
  std::vector<Eigen::Vector3d> b;
  for (const auto& point : a) b.push_back(truth * point);
  const Sim3 estimate = EstimateSim3(a, b);
  EXPECT_NEAR(estimate.scale, truth.scale, 1e-12);
  EXPECT_LT((estimate * a[5] - b[5]).norm(), 1e-12);
}

TEST(Alignment, MirroredPointsGiveARotationNotAReflection) {
  const auto a = RandomPoints(10, 3);
  std::vector<Eigen::Vector3d> b;
  for (const auto& point : a) b.emplace_back(-point.x(), point.y(), point.z());
  const Rigid3 estimate = EstimateRigid3(a, b);
  EXPECT_NEAR(estimate.rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
}

TEST(Alignment, PointOfZeroWeightHasNoInfluence) {
  const auto a = RandomPoints(6, 4);
  std::vector<Eigen::Vector3d> b = a;
  b[2] += Eigen::Vector3d(100, 0, 0);
  std::vector<double> weights(a.size(), 1.0);
  weights[2] = 0.0;
  EXPECT_LT((EstimateRigid3(a, b, weights) * a[0] - a[0]).norm(), 1e-12);
  EXPECT_GT((EstimateRigid3(a, b) * a[0] - a[0]).norm(), 1.0);
}

TEST(Alignment, SpreadTellsLinesFromPlanes) {
  std::vector<Eigen::Vector3d> line;
  for (int i = 0; i < 5; ++i) line.emplace_back(i, 2.0 * i, -i);
  EXPECT_FALSE(HasSpread(line));
  EXPECT_FALSE(HasSpread({line[0], line[1]}));
  EXPECT_FALSE(HasSpread({line[0], line[0], line[0]}));
  line[2] += Eigen::Vector3d(1, 0, 0);
  EXPECT_TRUE(HasSpread(line));
}

}  // namespace
}  // namespace velamap
