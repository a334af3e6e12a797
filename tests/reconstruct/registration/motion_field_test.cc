#include "reconstruct/registration/motion_field.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace velamap {
namespace {

constexpr double kFocal_px = 1000, kSide_px = 60;

// Of the picture of a camera that turns; the principal point is the origin.
Eigen::Vector2d VelocityWhileTurning(const Eigen::Vector3d& turn_rad_s, const Eigen::Vector2d& p) {
  const Eigen::Vector2d q = p / kFocal_px;
  return kFocal_px *
         Eigen::Vector2d(q.x() * q.y() * turn_rad_s.x() - (1 + q.x() * q.x()) * turn_rad_s.y() +
                             q.y() * turn_rad_s.z(),
                         (1 + q.y() * q.y()) * turn_rad_s.x() - q.x() * q.y() * turn_rad_s.y() -
                             q.x() * turn_rad_s.z());
}

class MotionFieldTest : public testing::Test {
 protected:
  double Uniform(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }

  std::vector<PlacedMotion> Turning(const Eigen::Vector3d& turn_rad_s, int num) {
    std::vector<PlacedMotion> motions;
    for (int i = 0; i < num; ++i) {
      const Eigen::Vector2d place(Uniform(-800, 800), Uniform(-450, 450));
      MotionVector motion = MotionVector::Zero();
      motion.head<2>() = VelocityWhileTurning(turn_rad_s, place);
      motions.push_back({place, motion});
    }
    return motions;
  }

  std::mt19937 random_{1};
};

TEST_F(MotionFieldTest, IsExactWhileTheCameraTurns) {
  for (int draw = 0; draw < 20; ++draw) {
    const Eigen::Vector3d turn_rad_s(Uniform(-2, 2), Uniform(-2, 2), Uniform(-2, 2));
    const MotionField field(Turning(turn_rad_s, 20), kSide_px);
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector2d place(Uniform(-800, 800), Uniform(-450, 450));
      EXPECT_LT((field.At(place).head<2>() - VelocityWhileTurning(turn_rad_s, place)).norm(), 1e-6);
    }
  }
}

// Whatever the markers, also those that determine no quadratic terms.
TEST_F(MotionFieldTest, AffineMotionsAreExactWhereMarkersSpread) {
  Eigen::Matrix<double, 6, 2> gradient;
  gradient << 0.3, -0.2, 0.1, 0.4, 2, -3, 1, 5, 20, -30, 10, 50;
  const MotionVector at_origin = (MotionVector() << 120, -80, 10, 30, 100, -300).finished();
  const auto motion_at = [&](const Eigen::Vector2d& p) -> MotionVector {
    return at_origin + gradient * p;
  };
  for (int num = 3; num < 12; ++num) {
    std::vector<PlacedMotion> motions;
    for (int i = 0; i < num; ++i) {
      const Eigen::Vector2d place(170 * i + Uniform(-30, 30), 300 * (i % 2));
      motions.push_back({place, motion_at(place)});
    }
    const MotionField field(motions, kSide_px);
    for (const PlacedMotion& known : motions) {
      const Eigen::Vector2d corner =
          known.x_in_image_px + Eigen::Vector2d(kSide_px / 2, -kSide_px / 2);
      EXPECT_LT((field.At(corner) - motion_at(corner)).norm(), 1e-6) << num;
    }
  }
}

// The noise at the corners is hardly larger than that of the motions, wherever the markers are.
TEST_F(MotionFieldTest, NoiseIsNotExtrapolatedToCorners) {
  std::normal_distribution<double> normal;
  for (int num = 3; num < 30; num += 3) {
    double sum_of_squares = 0.0;
    constexpr int kNumDraws = 200;
    for (int draw = 0; draw < kNumDraws; ++draw) {
      const Eigen::Vector2d spread(Uniform(10, 600), Uniform(10, 600));
      std::vector<PlacedMotion> motions;
      for (int i = 0; i < num; ++i) {
        MotionVector motion = MotionVector::Zero();
        motion.head<2>() = Eigen::Vector2d(normal(random_), normal(random_));
        motions.push_back({{Uniform(-1, 1) * spread.x(), Uniform(-1, 1) * spread.y()}, motion});
      }
      const MotionField field(motions, kSide_px);
      for (const PlacedMotion& known : motions) {
        const Eigen::Vector2d corner =
            known.x_in_image_px + Eigen::Vector2d(kSide_px / 2, kSide_px / 2);
        // As for corners of a marker whose own motion is measured.
        const MotionVector error = known.motion + field.At(corner) - field.At(known.x_in_image_px);
        sum_of_squares += error.head<2>().squaredNorm() / (2.0 * num);
      }
    }
    EXPECT_LT(std::sqrt(sum_of_squares / kNumDraws), 1.6) << num;
  }
}

}  // namespace
}  // namespace velamap
