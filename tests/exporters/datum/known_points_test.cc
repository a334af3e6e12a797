#include "exporters/datum/known_points.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/datum/known_points_report.h"
#include "importer/base/statistics.h"
#include "tests/exporters/datum/known_points_fixture.h"

namespace velamap {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::Each;
using testing::HasSubstr;

std::vector<PointState> StatesOf(const KnownPointFit& fit) {
  std::vector<PointState> states;
  for (const ComparedPoint& point : fit.points) states.push_back(point.state);
  return states;
}

TEST_F(KnownPoints, ExactCoordinatesGiveTheExactFrame) {
  for (int draw = 0; draw < 50; ++draw) {
    MakeShape(6);
    AddCenters(3, 0.0);
    Add(4, 2, 0.0);
    ExpectTheTrueFrame(1e-9, "centres and a corner");
    EXPECT_THAT(StatesOf(Fit()), Each(PointState::kUsed));
  }
}

TEST_F(KnownPoints, AnyCoordinatesThatDetermineItGiveTheExactFrame) {
  for (int draw = 0; draw < 20; ++draw) {
    MakeShape(9);
    Add(1, 0, 0.0);
    Add(2, 0, 0.0, "xy");
    Add(3, 3, 0.0, "yz");
    for (const int id : {4, 5, 6}) Add(id, 0, 0.0, "z");
    for (const int id : {7, 8, 9}) Add(id, 1, 0.0, "x");
    ExpectTheTrueFrame(1e-8, "levels and planes");
  }
}

TEST_F(KnownPoints, FarOriginsLoseNoDigits) {
  MakeShape(6);
  known_from_shape_.translation = {5.4e5, 4.5e6, 300};
  AddCenters(6, 0.0);
  ExpectTheTrueFrame(1e-7, "a national grid");
}

TEST_F(KnownPoints, AnOutlierAmongSixIsNamedAndLeftOut) {
  for (int draw = 0; draw < 40; ++draw) {
    MakeShape(6);
    AddCenters(6, kSigma_m);
    const std::size_t wrong = static_cast<std::size_t>(draw) % 6;
    *layout_.known_points[wrong].x_m[static_cast<std::size_t>(draw) % 3] += 0.04;
    const KnownPointFit fit = Fit();
    ASSERT_TRUE(fit.known_from_shape) << fit.reason;
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(fit.points[i].state, i == wrong ? PointState::kLeftOut : PointState::kUsed)
          << "draw " << draw << ", point " << i;
    }
    EXPECT_NEAR(fit.points[wrong].difference_m.norm(), 0.04, 0.015);
    const std::vector<std::string> warnings = KnownPointWarnings(fit);
    ASSERT_FALSE(warnings.empty());
    EXPECT_THAT(warnings[0], HasSubstr("known point " + std::to_string(wrong + 1) + " is "));
  }
}

TEST_F(KnownPoints, ThreeOutliersAmongEightAreLeftOut) {
  for (int draw = 0; draw < 20; ++draw) {
    MakeShape(8);
    AddCenters(8, kSigma_m);
    for (const std::size_t wrong : {1, 4, 6}) {
      *layout_.known_points[wrong].x_m[0] += 0.3;  // all to the same side
      *layout_.known_points[wrong].x_m[1] -= 0.1 * static_cast<double>(wrong);
    }
    const KnownPointFit fit = Fit();
    ASSERT_TRUE(fit.known_from_shape) << fit.reason;
    for (std::size_t i = 0; i < 8; ++i) {
      const bool is_wrong = i == 1 || i == 4 || i == 6;
      EXPECT_EQ(fit.points[i].state, is_wrong ? PointState::kLeftOut : PointState::kUsed);
    }
  }
}

TEST_F(KnownPoints, ResidualsAreAsLargeAsTheSigmasSay) {
  constexpr int kNumDraws = 200;
  double sum = 0.0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    MakeShape(6);
    AddCenters(6, kSigma_m);
    sum += std::pow(Fit().residual_in_sigmas.value(), 2);
  }
  // 12 redundant coordinates: a standard deviation of 0.03.
  EXPECT_NEAR(sum / kNumDraws, 1.0, 0.1);
}

TEST_F(KnownPoints, ChecksOfTheJointCovarianceFailAsOftenAsTheyShould) {
  MakeShape(9);
  const PointCovariance covariance = Covariance(kSigma_m);
  const MarkerShape truth = shape_;
  constexpr int kNumDraws = 400;
  int num_failed = 0, num_checks = 0;
  double sum_of_residuals = 0.0, sum_of_checks = 0.0;
  SampleShapes(truth, covariance, kNumDraws, [&](const MarkerShape& sample) {
    shape_ = truth;
    layout_.known_points.clear();
    AddCenters(5, kSigma_m);
    Add(6, 0, kSigma_m, "z");
    for (const int id : {7, 8, 9}) Add(id, id == 9 ? 2 : 0, kSigma_m).is_check = true;
    shape_ = sample;
    const KnownPointFit fit = Fit(&covariance);
    ASSERT_TRUE(fit.known_from_shape) << fit.reason;
    sum_of_residuals += std::pow(*fit.residual_in_sigmas, 2);
    num_failed += CountPoints(fit, PointState::kFailed);
    for (const ComparedPoint& point : fit.points) {
      if (!point.known.is_check) continue;
      ++num_checks;
      // Back to chi-squared of three coordinates, whose mean is 3.
      sum_of_checks += std::pow(point.sigmas_off * 3.7625 / 3, 2) / 3;
    }
  });
  EXPECT_EQ(num_checks, 3 * kNumDraws);
  EXPECT_NEAR(sum_of_residuals / kNumDraws, 1.0, 0.1);
  EXPECT_NEAR(sum_of_checks / num_checks, 1.0, 0.12);
  // 0.27 % of 1200 are 3.2.
  EXPECT_GE(num_failed, 1);
  EXPECT_LE(num_failed, 9);
}

TEST_F(KnownPoints, ACheckFarOffFailsAndChangesNothing) {
  MakeShape(6);
  AddCenters(5, kSigma_m);
  const Rigid3 before = Fit().known_from_shape.value();
  KnownPoint& check = Add(6, 0, 0.0);
  check.is_check = true;
  EXPECT_EQ(Fit().points.back().state, PointState::kPassed);
  *check.x_m[2] += 0.02;
  const KnownPointFit fit = Fit();
  EXPECT_EQ(fit.points.back().state, PointState::kFailed);
  EXPECT_NEAR(fit.points.back().difference_m.z(), -0.02, 5e-3);
  EXPECT_LT(AngularDistance(*fit.known_from_shape, before), 1e-12);
  EXPECT_THAT(KnownPointWarnings(fit), testing::ElementsAre(HasSubstr("check point 6 is ")));
}

TEST_F(KnownPoints, TheSizeThatTheyAskForIsReportedWithItsSigma) {
  std::vector<double> in_sigmas;
  for (int draw = 0; draw < 100; ++draw) {
    MakeShape(6);
    AddCenters(6, kSigma_m);
    for (ShapeMarker& marker : shape_.markers) {
      for (auto& x : marker.x_in_shape_m) *x *= 1.002;
    }
    const UncertainValue change = Fit().scale_change.value();
    in_sigmas.push_back((change.value + 0.002) / change.sigma);
  }
  const Statistics statistics = ComputeStatistics(in_sigmas);
  EXPECT_NEAR(statistics.mean, 0.0, 0.4);
  EXPECT_NEAR(statistics.standard_deviation, 1.0, 0.25);
}

TEST_F(KnownPoints, AWrongSizeIsBlamedOnTheShapeAndNotOnThePoints) {
  for (int draw = 0; draw < 20; ++draw) {
    MakeShape(7);
    AddCenters(7, kSigma_m);
    for (ShapeMarker& marker : shape_.markers) {
      for (auto& x : marker.x_in_shape_m) *x *= 1.03;
    }
    const KnownPointFit fit = Fit();
    EXPECT_THAT(StatesOf(fit), Each(PointState::kUsed)) << fit.reason;
    ASSERT_TRUE(fit.scale_change);
    EXPECT_NEAR(fit.scale_change->value, -0.03, 0.01);
    EXPECT_TRUE(fit.ContradictsScale());
  }
}

TEST_F(KnownPoints, ProbableCausesOfContradictionsAreNamed) {
  const auto expect_reason = [this](const std::string& words) {
    const KnownPointFit fit = Fit();
    EXPECT_FALSE(fit.known_from_shape);
    EXPECT_TRUE(fit.is_contradicted);
    EXPECT_THAT(fit.reason, HasSubstr(words));
    EXPECT_THAT(StatesOf(fit), Each(PointState::kNotCompared));
  };
  for (int draw = 0; draw < 20; ++draw) {
    MakeShape(6);
    AddCenters(6, kSigma_m);
    for (KnownPoint& point : layout_.known_points) *point.x_m[0] *= -1;
    expect_reason("right-handed");
  }
  MakeShape(6);
  AddCenters(6, kSigma_m);
  for (KnownPoint& point : layout_.known_points) {
    for (auto& x : point.x_m) *x *= 1000;
  }
  expect_reason("not millimetres");
  for (KnownPoint& point : layout_.known_points) {
    for (auto& x : point.x_m) *x *= 0.0005;
  }
  expect_reason(" times as far apart as in the shape: check their unit");
  for (int draw = 0; draw < 20; ++draw) {
    MakeShape(3);
    AddCenters(3, kSigma_m);
    // Farther from the first point, which no turn explains.
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double& x = *layout_.known_points[1].x_m[axis];
      x += 0.06 * (x - *layout_.known_points[0].x_m[axis]);
    }
    expect_reason("no more than half of 3 agree");
  }
}

TEST_F(KnownPoints, WhatIsMissingIsSaid) {
  const auto reason = [this] {
    const KnownPointFit fit = Fit();
    EXPECT_FALSE(fit.known_from_shape);
    EXPECT_FALSE(fit.is_contradicted);
    return fit.reason;
  };
  MakeShape(6);
  EXPECT_EQ(reason(), "");
  for (const int id : {1, 2, 3, 4}) Add(id, 0, 0.0, "z");
  EXPECT_EQ(reason(),
            "they have z alone, which leaves shifts along x and y and a turn about z open");
  Add(5, 0, 0.0, "xyz");
  EXPECT_EQ(reason(), "the known points leave a turn about z open");
  layout_.known_points.clear();
  AddCenters(2, 0.0);
  EXPECT_EQ(reason(), "2 points are given; three are needed");
  Add(3, 0, 0.0, "z");
  // A level is of little use where the turn about the line of the two leaves it as it is.
  EXPECT_THAT(reason(), AnyOf(HasSubstr("fit in two places"), HasSubstr("leave a turn about the")));
  Add(4, 0, 0.0).sigma_m = 0.02;
  EXPECT_TRUE(Fit().known_from_shape) << Fit().reason;
  layout_.known_points.clear();
  for (const int id : {1, 2, 3, 4}) Add(id, 0, 0.0, "yz");
  EXPECT_EQ(reason(), "none has x, which leaves a shift along x open");
  layout_.known_points.clear();
  for (const int id : {1, 2}) Add(id, 0, 0.0);
  Add(3, 0, 0.0).marker_id = 99;
  EXPECT_THAT(reason(), AllOf(HasSubstr("2 points are given"), HasSubstr("99 not reconstructed")));
  Add(3, 0, 0.0).is_check = true;
  EXPECT_THAT(reason(), HasSubstr("2 points are given"));
}

TEST_F(KnownPoints, PointsOnALineLeaveTheTurnAboutItOpen) {
  MakeShape(5);
  known_from_shape_.rotation.setIdentity();
  for (ShapeMarker& marker : shape_.markers) {
    marker = SquareMarker(marker.marker_id, 0.1, {{}, {0, 0.7 * marker.marker_id, 0}});
  }
  AddCenters(5, 0.0);
  EXPECT_EQ(Fit().reason, "the known points leave a turn about y open");
  known_from_shape_.rotation = Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitZ());
  layout_.known_points.clear();
  AddCenters(5, 0.0);
  EXPECT_THAT(Fit().reason, AnyOf(HasSubstr("a turn about the direction (-0.56 0.83 "),
                                  HasSubstr("a turn about the direction (0.56 -0.83 ")));
}

}  // namespace
}  // namespace velamap
