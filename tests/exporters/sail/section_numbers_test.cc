// The sigmas of the numbers of a section.

#include "exporters/sail/section_numbers.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "importer/geometry/units.h"
#include "tests/exporters/sail/sail_shapes.h"

namespace velamap {
namespace {

// Compares standard deviations with the scatter of the numbers under such noise.
TEST(SectionNumbers, SigmasAgreeWithMonteCarlo) {
  constexpr double kSigma_m = 0.003;
  constexpr int kNumRuns = 50;
  Sail sail = ExampleSail(8);
  SetSigma(kSigma_m, &sail.shape);
  const FrameChoice camera{FrameKind::kCamera};
  const SectionOptions options{{1.2}};
  const SectionReport stated = SectionsOf(sail, options, camera);
  ASSERT_EQ(stated.sections.size(), 4u);
  const auto numbers = [](const SectionReport& report, std::size_t i) {
    Eigen::Matrix<double, 6, 1> values;
    for (int k = 0; k < 6; ++k)
      values[k] = NumbersOf(report.sections[i])[static_cast<std::size_t>(k)];
    return values;
  };
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, kSigma_m);
  std::vector<Eigen::Matrix<double, 6, 1>> sums(4, Eigen::Matrix<double, 6, 1>::Zero()),
      squares = sums;
  for (int run = 0; run < kNumRuns; ++run) {
    Sail noisy = sail;
    for (ShapeMarker& marker : noisy.shape.markers) {
      const Eigen::Vector3d shift(noise(random), noise(random), noise(random));
      ShiftMarker(marker.marker_id, shift, &noisy.shape);
    }
    const SectionReport report = SectionsOf(noisy, options, camera);
    ASSERT_EQ(report.sections.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto difference = (numbers(report, i) - numbers(stated, i)).eval();
      sums[i] += difference;
      squares[i] += difference.cwiseAbs2();
    }
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const Section& section = stated.sections[i];
    const std::vector<double> sigmas = {
        *section.chord_m.sigma,         *section.camber.sigma,
        *section.draft_position->sigma, *section.entry_angle_deg.sigma,
        *section.exit_angle_deg.sigma,  *section.twist_deg->sigma};
    for (int k = 0; k < 6; ++k) {
      if (i == 0 && k == 5) continue;  // the lowest section's twist is 0 by definition
      const double spread = std::sqrt(squares[i][k] / kNumRuns);
      EXPECT_NEAR(spread / sigmas[static_cast<std::size_t>(k)], 1, 0.3)
          << section.name << " number " << k;
    }
  }
}

TEST(SectionNumbers, JointCovarianceLetsSharedErrorsCancel) {
  // A common error of all corners of 10 mm, and an individual one of each marker of 1 mm.
  Sail sail = ExampleSail(8);
  PointCovariance covariance;
  for (const ShapeMarker& marker : sail.shape.markers) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      covariance.point3D_ids.push_back(Point3DIdFromCorner({marker.marker_id, corner}));
    }
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(12, 12);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        block.block<3, 3>(3 * i, 3 * j) = 1e-6 * Eigen::Matrix3d::Identity();
      }
    }
    covariance.blocks.push_back(block);
  }
  const auto num_points = static_cast<Eigen::Index>(covariance.point3D_ids.size());
  covariance.factor = 0.01 * Eigen::Matrix3d::Identity().replicate(num_points, 1);
  covariance.signs = Eigen::VectorXd::Ones(3);

  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  SetSigma(0.001, &sail.shape);
  const SectionReport own = ComputeSections(sail.shape, frame, sail.layout, nullptr);
  const SectionReport joint = ComputeSections(sail.shape, frame, sail.layout, &covariance);
  SetSigma(0.01, &sail.shape);
  const SectionReport apart = ComputeSections(sail.shape, frame, sail.layout, nullptr);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(*joint.sections[i].camber.sigma / *own.sections[i].camber.sigma, 1, 0.05);
    EXPECT_NEAR(*joint.sections[i].chord_m.sigma / *own.sections[i].chord_m.sigma, 1, 0.05);
    EXPECT_GT(*apart.sections[i].chord_m.sigma, 5 * *joint.sections[i].chord_m.sigma);
  }
}

TEST(SectionNumbers, NoiseIsSmoothedByItsSigma) {
  Sail sail = ExampleSail(15);
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0, 0.004);
  for (ShapeMarker& marker : sail.shape.markers) {
    ShiftMarker(marker.marker_id, {noise(random), noise(random), noise(random)}, &sail.shape);
  }
  const auto rms_angle_error = [&](double sigma_m) {
    SetSigma(sigma_m, &sail.shape);
    double sum = 0;
    const SectionReport report = SectionsOf(sail);
    const std::vector<double> cambers = {0.08, 0.10, 0.12};
    for (std::size_t i = 0; i < 3; ++i) {
      const double truth_deg = 2 * std::atan(2 * cambers[i]) * kDegPerRad;
      sum += std::pow(report.sections[i].entry_angle_deg.value - truth_deg, 2) +
             std::pow(report.sections[i].exit_angle_deg.value - truth_deg, 2);
    }
    return std::sqrt(sum / 6);
  };
  EXPECT_LT(rms_angle_error(0.004), 0.6 * rms_angle_error(1e-6));
}

TEST(SectionNumbers, SigmasNeedAllMarkersOfTheSection) {
  Sail sail = ExampleSail();
  SetSigma(0.001, &sail.shape);
  sail.shape.markers[14].sigma_m[0].reset();  // on h2
  const SectionReport report = SectionsOf(sail);
  EXPECT_TRUE(report.sections[0].camber.sigma);
  EXPECT_FALSE(report.sections[1].camber.sigma);
  EXPECT_FALSE(report.sections[1].twist_deg->sigma);
  EXPECT_TRUE(report.sections[2].twist_deg->sigma);
}

}  // namespace
}  // namespace velamap
