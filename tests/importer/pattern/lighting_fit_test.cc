#include "importer/pattern/lighting_fit.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "importer/geometry/units.h"
#include "importer/pattern/pattern_fit.h"
#include "tests/importer/refine/marker_grid.h"

namespace velamap {
namespace {

// Light on a marker as a factor; places are relative to its middle, in parts of its side.
using Light = std::function<double(const Eigen::Vector2d& place)>;

double SoftStep(double x, double sigma) { return 0.5 * std::erfc(-x / (std::sqrt(2.0) * sigma)); }

// The edges of shadows, stays and light that falls off, at random.
Light DrawLight(std::mt19937* random) {
  const auto between = [&](double low, double high) {
    return low + (high - low) * ((*random)() / 4294967296.0);
  };
  const double angle = between(0, 2 * kPi), offset = between(-0.5, 0.3), depth = between(0.25, 0.6);
  const double width = (*random)() % 3 == 0 ? between(0.3, 0.6) : 9.0, edge = between(0.06, 0.3);
  const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
  return [=](const Eigen::Vector2d& place) {
    const double across = normal.dot(place) - offset;
    return 1 - depth * (SoftStep(across, edge) - SoftStep(across - width, edge));
  };
}

struct LitGrid {
  MarkerGrid grid;
  ImageFormation formation;
};

// Markers as a camera of gamma 2.2 records them. Each has a light of its own.
LitGrid MakeLitGrid(double side_px, const std::function<Light()>& draw_light) {
  MarkerGridOptions options;
  options.side_px = side_px;
  options.max_tilt_deg = 45;
  options.rendering.white = 220;
  options.rendering.black = 12;
  options.rendering.quiet_zone_cells = 2;
  ImageFormationParameters camera;
  camera.gamma = 2.2;
  LitGrid lit{MakeMarkerGrid(options), ImageFormation(camera)};
  cv::Mat light;
  lit.grid.image.convertTo(light, CV_32F);
  for (const QuadCorners& corners : lit.grid.truth) {
    const Light factor = draw_light();
    const Eigen::Vector2d center = QuadCenter(corners);
    const double reach_px = 1.6 * side_px;
    for (int y = 0; y < light.rows; ++y) {
      for (int x = 0; x < light.cols; ++x) {
        const Eigen::Vector2d from_center = Eigen::Vector2d(x, y) - center;
        if (from_center.cwiseAbs().maxCoeff() > 0.8 * reach_px) continue;
        light.at<float>(y, x) *= static_cast<float>(factor(from_center / side_px));
      }
    }
  }
  cv::theRNG().state = 5;
  cv::Mat noise(light.size(), CV_32F);
  cv::randn(noise, 0, 1);
  light.forEach<float>([&](float& value, const int*) {
    value = static_cast<float>(lit.formation.tone().Encode(static_cast<double>(value)));
  });
  light += noise;
  light.convertTo(lit.grid.image, CV_8U);
  return lit;
}

struct Fits {
  int num_markers = 0, num_fitted = 0;
  double error_px = 0.0;          // RMS of a coordinate
  double error_over_sigma = 0.0;  // RMS
};

Fits FitAll(const LitGrid& lit) {
  Fits fits;
  for (std::size_t k = 0; k < lit.grid.truth.size(); ++k) {
    ++fits.num_markers;
    const auto refined =
        FitPattern(lit.grid.image, lit.grid.starts[k], {lit.grid.cells[k]}, lit.formation);
    if (!refined) continue;
    ++fits.num_fitted;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const double square = (refined->corners_px[i] - lit.grid.truth[k][i]).squaredNorm();
      const double sigma_px = std::hypot(refined->sigma_px[i], 0.02);
      fits.error_px += square / (2 * kNumCorners);
      fits.error_over_sigma += square / (2 * kNumCorners * sigma_px * sigma_px);
    }
  }
  fits.error_px = std::sqrt(fits.error_px / fits.num_fitted);
  fits.error_over_sigma = std::sqrt(fits.error_over_sigma / fits.num_fitted);
  return fits;
}

TEST(LightingFit, ShadowsHardlyMoveCorners) {
  std::mt19937 random(3);
  for (const double side_px : {20.0, 32.0}) {
    const Fits fits = FitAll(MakeLitGrid(side_px, [&] { return DrawLight(&random); }));
    const Fits even =
        FitAll(MakeLitGrid(side_px, [] { return [](const Eigen::Vector2d&) { return 1.0; }; }));
    EXPECT_EQ(fits.num_fitted, fits.num_markers);
    EXPECT_LT(fits.error_px, 3 * even.error_px) << side_px;
    EXPECT_LT(fits.error_over_sigma, 1.6) << side_px;
    RecordProperty("error_px", std::to_string(fits.error_px));
    RecordProperty("even_px", std::to_string(even.error_px));
  }
}

TEST(LightingFit, LightThatFallsOffHardlyMovesCorners) {
  const auto falling_off = [](const Eigen::Vector2d& place) {
    return std::exp(-0.9 * (place + Eigen::Vector2d(0.3, -0.2)).squaredNorm());
  };
  const Fits fits = FitAll(MakeLitGrid(25, [&] { return falling_off; }));
  EXPECT_EQ(fits.num_fitted, fits.num_markers);
  EXPECT_LT(fits.error_px, 0.03);
  EXPECT_LT(fits.error_over_sigma, 1.5);
}

}  // namespace
}  // namespace velamap
