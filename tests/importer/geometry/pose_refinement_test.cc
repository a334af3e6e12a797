#include "importer/geometry/pose_refinement.h"

#include <random>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "importer/geometry/opencv_pose.h"
#include "importer/geometry/p3p.h"
#include "tests/support/gradient_check.h"

namespace velamap {
namespace {

Rigid3 TruePose() {
  return {Eigen::Quaterniond(0.1, 0.95, -0.2, 0.15).normalized(), {0.1, -0.2, 4.0}};
}

std::vector<RayObservation> Observe(double noise, unsigned int seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, noise);
  std::vector<RayObservation> observations;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector3d x(place(random), place(random), 0.2 * place(random));
    const Eigen::Vector2d ray = (TruePose() * x).hnormalized();
    observations.push_back({x, ray});
    if (noise > 0) observations.back().ray += Eigen::Vector2d(normal(random), normal(random));
  }
  return observations;
}

Rigid3 Perturbed(double size) {
  PoseStep step;
  step << size, -size, 0.5 * size, size, size, -size;
  return PlusPose(TruePose(), step);
}

TEST(RefinePose, DerivativesAreThoseOfTheCost) {
  const std::vector<RayObservation> observations = Observe(0.01, 1);
  ExpectGradientOfCost(RayPoseProblem<TrivialLoss>(observations, {}), Perturbed(0.1), 1e-6);
  ExpectGradientOfCost(RayPoseProblem<CauchyLoss>(observations, {1e-4}), Perturbed(0.1), 1e-6);
}

TEST(RefinePose, NoiseFreeRaysGiveTheTruePose) {
  const Rigid3 refined = RefinePose(Observe(0.0, 2), Perturbed(0.2));
  EXPECT_LT(AngularDistance(refined, TruePose()), 1e-9);
  EXPECT_LT((refined.translation - TruePose().translation).norm(), 1e-9);
}

TEST(RefinePose, EndsWhereOpenCvEnds) {
  const std::vector<RayObservation> observations = Observe(1e-3, 3);
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> rays;
  for (const RayObservation& observation : observations) {
    const Eigen::Vector3d& x = observation.x_in_world;
    points.emplace_back(x.x(), x.y(), x.z());
    rays.emplace_back(observation.ray.x(), observation.ray.y());
  }
  const Eigen::AngleAxisd start(Perturbed(0.01).rotation);
  const Eigen::Vector3d axis_angle = start.angle() * start.axis();
  cv::Mat rotation = (cv::Mat_<double>(3, 1) << axis_angle.x(), axis_angle.y(), axis_angle.z());
  const Eigen::Vector3d& t = TruePose().translation;
  cv::Mat translation = (cv::Mat_<double>(3, 1) << t.x(), t.y(), t.z());
  cv::solvePnPRefineLM(points, rays, cv::Matx33d::eye(), cv::noArray(), rotation, translation,
                       {cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, 100, 1e-14});
  const Rigid3 by_opencv = RigidFromOpenCV(rotation, translation);
  const Rigid3 refined = RefinePose(observations, Perturbed(0.01));
  EXPECT_LT(AngularDistance(refined, by_opencv), 1e-7);
  EXPECT_LT((refined.translation - by_opencv.translation).norm(), 1e-6);
}

TEST(RefinePose, ALossKeepsWrongRaysFromPulling) {
  std::vector<RayObservation> observations = Observe(0.0, 4);
  for (std::size_t i = 0; i < 5; ++i) observations[i].ray.x() += 0.2;
  const auto error = [](const Rigid3& pose) { return AngularDistance(pose, TruePose()); };
  EXPECT_LT(error(RefinePose(observations, Perturbed(0.001), CauchyLoss{1e-6})), 1e-4);
  EXPECT_GT(error(RefinePose(observations, Perturbed(0.001))), 1e-3);
}

TEST(RefinePose, AStartBehindThePointsStays) {
  Rigid3 behind = TruePose();
  behind.translation.z() = -4.0;
  const Rigid3 refined = RefinePose(Observe(0.0, 5), behind);
  EXPECT_EQ(refined.translation, behind.translation);
  EXPECT_EQ(refined.rotation.coeffs(), behind.rotation.coeffs());
}

TEST(SolveP3P, OneOfThePosesIsTheTrueOne) {
  const std::vector<RayObservation> observations = Observe(0.0, 6);
  const auto poses =
      SolveP3P({observations[0].x_in_world, observations[1].x_in_world, observations[2].x_in_world},
               {observations[0].ray, observations[1].ray, observations[2].ray});
  ASSERT_LE(poses.size(), 4u);
  EXPECT_TRUE(std::any_of(poses.begin(), poses.end(), [](const Rigid3& pose) {
    return AngularDistance(pose, TruePose()) < 1e-6;
  }));
}

TEST(SampleCorners, AreOfThreeMarkers) {
  std::mt19937 generator(1);
  int num_samples = 0;
  for (int i = 0; i < 100; ++i) {
    const auto sample = SampleCorners(4, &generator);
    if (!sample) continue;
    ++num_samples;
    for (const SampledCorner& corner : *sample) {
      EXPECT_LT(corner.marker_idx, 4u);
      EXPECT_LT(corner.corner_idx, 4u);
    }
    EXPECT_NE((*sample)[0].marker_idx, (*sample)[1].marker_idx);
    EXPECT_NE((*sample)[1].marker_idx, (*sample)[2].marker_idx);
    EXPECT_NE((*sample)[0].marker_idx, (*sample)[2].marker_idx);
  }
  EXPECT_GT(num_samples, 20);
}

}  // namespace
}  // namespace velamap
