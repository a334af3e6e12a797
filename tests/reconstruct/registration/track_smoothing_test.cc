#include "reconstruct/registration/track_smoothing.h"

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

constexpr double kStep_s = 1.0 / 30, kNoise_px = 0.03;

// The motion of a hand: slow turns are large, fast ones small.
struct Shake {
  explicit Shake(std::mt19937* random) {
    std::uniform_real_distribution<double> phase(0.0, 6.283), frequency_Hz(0.5, 6.0);
    std::normal_distribution<double> normal;
    for (Wave& wave : waves) {
      const double hz = frequency_Hz(*random);
      wave = {6.283 * hz, phase(*random), 8.0 * normal(*random) / (1.0 + hz * hz)};
    }
  }

  double Place(double time_s) const {
    double sum = 0.0;
    for (const Wave& wave : waves) sum += wave.px * std::sin(wave.rad_s * time_s + wave.phase);
    return sum;
  }
  double Velocity(double time_s) const {
    double sum = 0.0;
    for (const Wave& wave : waves) {
      sum += wave.px * wave.rad_s * std::cos(wave.rad_s * time_s + wave.phase);
    }
    return sum;
  }

  struct Wave {
    double rad_s, phase, px;
  };
  std::array<Wave, 20> waves;
};

std::vector<double> TimesOf(int first, int last) {
  std::vector<double> times_s;
  for (int i = first; i <= last; ++i) times_s.push_back(i * kStep_s);
  return times_s;
}

// A clip of `num_points` points that shake as one, each with its own noise.
struct Clip {
  explicit Clip(int num_points, std::mt19937* random) : shake(random), places_px(num_points, 60) {
    std::normal_distribution<double> noise_px(0.0, kNoise_px);
    for (int i = 0; i < places_px.cols(); ++i) {
      for (double& x : places_px.col(i)) x = shake.Place(i * kStep_s) + noise_px(*random);
    }
  }

  std::vector<TrackWindow> Windows() const {
    std::vector<TrackWindow> windows;
    for (int i = 8; i + 8 < places_px.cols(); ++i) {
      windows.push_back({TimesOf(-8, 8), 8, places_px.middleCols(i - 8, 17)});
    }
    return windows;
  }

  Shake shake;
  Eigen::MatrixXd places_px;
};

TEST(TrackSmoothing, DifferentiatesPolynomialsExactly) {
  const TrackModel model{0.03, 0.1, 1.0};
  const std::vector<double> all_s = {-0.07, 0.0, 0.03, 0.11, 0.13, 0.2};
  for (const int num_times : {3, 4, 6}) {
    const std::vector<double> times_s(all_s.begin(), all_s.begin() + num_times);
    const Eigen::ArrayXd times = Eigen::Map<const Eigen::ArrayXd>(times_s.data(), num_times);
    Eigen::ArrayXd places_px = 5 + 70 * times - 40 * times.square();
    if (num_times > 3) places_px += 300 * times.cube();
    const Eigen::Vector3d derivatives =
        WeighPlaces(times_s, model).values.transpose() * places_px.matrix();
    EXPECT_NEAR(derivatives[0], 70, 1e-8);
    EXPECT_NEAR(derivatives[1], -80, 1e-6);
    EXPECT_NEAR(derivatives[2], num_times > 3 ? 1800 : 0, 1e-4);
  }
}

TEST(TrackSmoothing, FindsTheNoiseOfTheTracks) {
  std::mt19937 random(1);
  for (int draw = 0; draw < 5; ++draw) {
    std::vector<TrackWindow> windows = Clip(10, &random).Windows();
    // One point of ten has been mistaken for others.
    std::normal_distribution<double> wrong_px(0.0, 100.0);
    for (TrackWindow& window : windows) {
      for (double& x : window.places_px.row(3)) x = wrong_px(random);
    }
    const TrackModel model = FitTrackModel(windows);
    const double noise_px = std::sqrt(model.noise_ratio * model.motion_variance);
    EXPECT_NEAR(noise_px / kNoise_px, 1.0, 0.4) << draw;
  }
}

// In the middle of a clip and at its end, where a path is less certain.
TEST(TrackSmoothing, VarianceIsThatOfTheErrors) {
  std::mt19937 random(2);
  for (const int num_before : {8, 1, 0}) {
    std::vector<double> in_sigmas;
    for (int draw = 0; draw < 20; ++draw) {
      const Clip clip(1, &random);
      const TrackModel model = FitTrackModel(clip.Windows());
      const DerivativeWeights weights = WeighPlaces(TimesOf(-num_before, 8), model);
      const double variance = weights.noise_variance + weights.motion_variance;
      for (int i = num_before; i + 8 < 60; i += 5) {
        const double velocity_px_s =
            clip.places_px.row(0).segment(i - num_before, num_before + 9) * weights.values.col(0);
        in_sigmas.push_back((velocity_px_s - clip.shake.Velocity(i * kStep_s)) /
                            std::sqrt(variance));
      }
    }
    EXPECT_GT(Rms(in_sigmas), 0.6) << num_before;
    EXPECT_LT(Rms(in_sigmas), 1.3) << num_before;
  }
}

}  // namespace
}  // namespace velamap
