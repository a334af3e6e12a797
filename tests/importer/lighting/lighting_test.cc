#include "importer/lighting/lighting.h"

#include <cmath>

#include <gtest/gtest.h>

namespace velamap {
namespace {

Lighting TwoBands() {
  Lighting lighting;
  Lighting::Band soft, bright;
  soft << 0.7, -0.1, std::log(0.3), std::log(0.1), 0.4;
  bright << -2.0, 0.2, std::log(2.0), std::log(0.05), -0.6;
  lighting.AddBand(soft);
  lighting.AddBand(bright);
  Eigen::VectorXd bend = Eigen::VectorXd::Zero(lighting.parameters().size());
  bend.head<3>() << 0.3, -0.2, 0.5;
  lighting.Move(bend, 0.01);
  return lighting;
}

TEST(Lighting, DerivativesAreThoseOfTheLogarithm) {
  constexpr double kStep = 1e-5;
  const Lighting lighting = TwoBands();
  const Eigen::Index size = lighting.parameters().size();
  for (const Eigen::Vector2d& place :
       {Eigen::Vector2d(0, 0), {-0.1, -0.05}, {0.2, 0.3}, {-0.4, 0.1}}) {
    Eigen::VectorXd by_parameters(size);
    lighting.LogAt(place, &by_parameters);
    for (Eigen::Index i = 0; i < size; ++i) {
      Lighting more = lighting, less = lighting;
      more.Move(kStep * Eigen::VectorXd::Unit(size, i), 0.01);
      less.Move(-kStep * Eigen::VectorXd::Unit(size, i), 0.01);
      EXPECT_NEAR((more.LogAt(place) - less.LogAt(place)) / (2 * kStep), by_parameters[i], 1e-6)
          << i << " at " << place.transpose();
    }
  }
}

TEST(Lighting, TakesTheDepthOfABandInsideOfIt) {
  Lighting lighting;
  EXPECT_TRUE(lighting.IsEven());
  EXPECT_EQ(lighting.LogAt({0.3, -0.2}), 0);
  Lighting::Band band;
  band << 0.0, 0.1, std::log(0.2), std::log(0.01), 0.4;
  lighting.AddBand(band);
  EXPECT_FALSE(lighting.IsEven());
  EXPECT_NEAR(std::exp(lighting.LogAt({0.2, 0.4})), 0.6, 1e-9);
  EXPECT_NEAR(std::exp(lighting.LogAt({0.1, -0.4})), 0.8, 1e-9);
  EXPECT_NEAR(std::exp(lighting.LogAt({0.0, 0.0})), 1.0, 1e-9);
  EXPECT_NEAR(std::exp(lighting.LogAt({0.4, 0.0})), 1.0, 1e-9);
}

// A fit that diverges cannot turn the light off or backwards.
TEST(Lighting, StaysWithinLimits) {
  Lighting lighting = TwoBands();
  const Eigen::Index size = lighting.parameters().size();
  for (const double step : {1e6, -2e6}) {
    lighting.Move(Eigen::VectorXd::Constant(size, step), 0.02);
    for (double x = -0.7; x < 0.7; x += 0.1) {
      const double light = std::exp(lighting.LogAt({x, 0.3 * x}));
      EXPECT_TRUE(std::isfinite(light) && light > 0) << x;
    }
  }
}

}  // namespace
}  // namespace velamap
