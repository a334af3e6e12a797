#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "importer/camera/turned_camera.h"
#include "reconstruct/adjust/camera_adjustment.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/geometry/covariance_update.h"
#include "tests/reconstruct/scene_model.h"
#include "tests/reconstruct/sheet_model.h"

namespace velamap {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// Velocity of the camera frame.
struct Motion {
  Eigen::Vector3d linear_m_s, angular_rad_s;
};

// A hand-held camera that takes a scene in a video, of which the model holds one frame a second.
class RollingShutter : public testing::Test {
 protected:
  RollingShutter() { Stage({}); }

  // `camera` is that of SyntheticSceneOptions.
  void Stage(const Camera& camera, int num_frames = 9) {
    SyntheticSceneOptions options;
    options.camera = camera;
    options.num_rows = 3;
    options.num_columns = 4;
    options.num_frames = num_frames;
    scene_ = MakeSyntheticScene(options);
    truth_ = MakeSceneModel(scene_);
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    const auto draw = [&](double sigma) -> Eigen::Vector3d {
      const double x = normal(random), y = normal(random), z = normal(random);
      return sigma * Eigen::Vector3d(x, y, z);
    };
    motions_.clear();
    for (std::size_t i = 0; i < scene_.frames.size(); ++i)
      motions_.push_back({draw(0.3), draw(0.2)});
  }

  // How long the motion of a frame would have taken at its velocity to get where it is `time_s`
  // after the frame.
  double MotionTime_s(std::size_t frame_idx, double time_s) const {
    if (shake_Hz_ == 0) return time_s;
    const double turn_rad_s = 2 * 3.14159265358979 * shake_Hz_;
    const double phase = static_cast<double>(frame_idx);
    return (std::sin(turn_rad_s * time_s + phase) - std::sin(phase)) / turn_rad_s;
  }

  // How far the cloth is from its mean shape in a frame, in waves that differ between frames.
  Eigen::Vector3d Flap(std::size_t frame_idx, const Eigen::Vector3d& x_in_world) const {
    if (flaps_m_.empty()) return Eigen::Vector3d::Zero();
    const Eigen::Vector3d& flap_m = flaps_m_[frame_idx];
    return {0, 0,
            flap_m.x() * std::sin(9 * x_in_world.x() + 1000 * flap_m.y()) +
                flap_m.z() * std::sin(9 * x_in_world.y())};
  }

  // Detections in a frame of the scene `time_s` after it, each row at its own time.
  FrameDetections Detections(std::size_t frame_idx, double time_s, double rolling_shutter_s) const {
    FrameDetections detections = scene_.frames[frame_idx];
    const Motion& motion = motions_[frame_idx];
    for (MarkerDetection& marker : detections.markers) {
      for (int c = 0; c < kNumCorners; ++c) {
        Eigen::Vector2d& x_px = marker.corners_in_image_px[c];
        const Eigen::Vector3d x_in_world = scene_.x_in_world.at(marker.marker_id)[c + 1];
        const Eigen::Vector3d x =
            scene_.cam_from_world[frame_idx] * (x_in_world + Flap(frame_idx, x_in_world));
        for (int k = 0; k < 20; ++k) {  // the row decides the time that decides the row
          const double row = scene_.camera.width_px > scene_.camera.height_px
                                 ? x_px.y() / scene_.camera.height_px - 0.5
                                 : x_px.x() / scene_.camera.width_px - 0.5;
          x_px = ImageFromCam(scene_.camera,
                              x + MotionTime_s(frame_idx, time_s + rolling_shutter_s * row) *
                                      (motion.linear_m_s + motion.angular_rad_s.cross(x)))
                     .value();
        }
      }
    }
    detections.time_s = static_cast<double>(frame_idx) + time_s;
    return detections;
  }

  // Sets the model and what the frames beside its own tell.
  void Film(double rolling_shutter_s, double noise_px, std::uint32_t seed) {
    SyntheticScene film = scene_;
    std::vector<DatabaseImage> images;
    for (std::size_t i = 0; i < scene_.frames.size(); ++i) {
      film.frames[i] = Detections(i, 0, rolling_shutter_s);
    }
    if (noise_px > 0) AddNoise({noise_px, 0, 0, 0, seed}, &film);
    for (std::size_t i = 0; i < scene_.frames.size(); ++i) {
      images.push_back({static_cast<ImageId>(i + 1), 1, film.frames[i]});
      for (int step = has_frames_before_ ? -reach_ : 0; step <= reach_; ++step) {
        if (step == 0) continue;
        images.push_back({static_cast<ImageId>(100 + images.size()), 1,
                          Detections(i, step * frame_s_, rolling_shutter_s)});
      }
    }
    model_ = MakeSceneModel(film);
    corner_errors_ = CornerErrorsOf(images);
  }

  MarkerAdjustmentSummary Adjust(const MarkerAdjustmentOptions& options = {}) {
    return AdjustWithMarkers(options, scene_.layout, corner_errors_, &model_);
  }

  SyntheticScene scene_;
  Model truth_;
  std::vector<Motion> motions_;
  double shake_Hz_ = 0.0;  // of the motions, which are uniform without
  double frame_s_ = 1.0 / 30;
  int reach_ = 1;  // number of frames before and after each of the model's
  bool has_frames_before_ = true;
  std::vector<Eigen::Vector3d> flaps_m_;  // empty: the cloth is still
  Model model_;
  CornerErrors corner_errors_;
};

TEST_F(RollingShutter, IsFoundInEitherDirectionAndTakenOut) {
  MarkerAdjustmentOptions held;
  held.estimate_rolling_shutter = false;
  for (const double rolling_shutter_s : {0.02, -0.015}) {
    Film(rolling_shutter_s, 0.02, 1);
    const Model before = model_;
    const auto without = Adjust(held);
    const double error_without_m = MaxPointError(model_, truth_);
    model_ = before;
    const auto summary = Adjust();
    const AdjustmentUncertainty& found = summary.uncertainty;
    EXPECT_NEAR(found.rolling_shutter_s, rolling_shutter_s, 3 * found.rolling_shutter_sigma_s);
    EXPECT_LT(found.rolling_shutter_sigma_s, 0.05 * std::abs(rolling_shutter_s));
    EXPECT_LT(MaxPointError(model_, truth_), 0.3 * error_without_m);
    EXPECT_LT(summary.error_after_px.mean, 0.3 * without.error_after_px.mean);
    EXPECT_THAT(summary.warnings, IsEmpty());
    EXPECT_EQ(without.uncertainty.rolling_shutter_sigma_s, 0);
  }
}

// Otherwise the search for the camera would prefer a wrong one that imitates the motion.
TEST_F(RollingShutter, CornersThatItMovesAreExplainedByTheRightCamera) {
  Stage({}, 16);
  Film(0.02, 0.02, 1);
  double num_corners = 0.0;
  for (const ModelImage& image : model_.images) {
    num_corners += static_cast<double>(image.points2D.size());
  }
  EXPECT_GT(AdjustCameras({}, scene_.layout, corner_errors_, model_).explained, 0.9 * num_corners);
}

// The velocity changes by a sixth while a frame is read.
TEST_F(RollingShutter, IsFoundInAFastShake) {
  constexpr double kShutter_s = 0.0144;
  Stage({}, 20);
  for (Motion& motion : motions_) {
    motion.linear_m_s *= 5;
    motion.angular_rad_s *= 2;
  }
  shake_Hz_ = 4;
  frame_s_ = 1.0 / 60;
  reach_ = 2;
  Film(kShutter_s, 0.02, 1);
  const auto summary = Adjust();
  const AdjustmentUncertainty& found = summary.uncertainty;
  EXPECT_NEAR(found.rolling_shutter_s, kShutter_s, 3 * found.rolling_shutter_sigma_s);
  EXPECT_LT(found.rolling_shutter_sigma_s, 0.01 * kShutter_s);
  const double sigma_m =
      std::sqrt(Trace(found.points) / static_cast<double>(found.points.point3D_ids.size()));
  EXPECT_LT(MaxPointError(model_, truth_), 3 * sigma_m);
  EXPECT_LT(summary.error_after_px.mean, 0.03);
  EXPECT_THAT(summary.warnings, IsEmpty());
}

// A parabola through the first three frames is a seventh too fast in such a shake, and the time
// would be a tenth too short. Nothing is before these frames, so a fiftieth may remain, which the
// sigma contains.
TEST_F(RollingShutter, IsNotTooShortInTheFirstFramesOfClips) {
  constexpr int kNumDraws = 8;
  constexpr double kShutter_s = 0.02;
  Stage({}, 20);
  for (Motion& motion : motions_) motion.linear_m_s *= 3;
  shake_Hz_ = 3;
  reach_ = 12;
  has_frames_before_ = false;
  double sum_of_errors_s = 0.0, sum_of_squares = 0.0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    Film(kShutter_s, 0.05, static_cast<std::uint32_t>(draw));
    const AdjustmentUncertainty found = Adjust().uncertainty;
    ASSERT_GT(found.rolling_shutter_sigma_s, 0) << draw;
    EXPECT_LT(found.rolling_shutter_sigma_s, 0.05 * kShutter_s) << draw;
    const double error_s = found.rolling_shutter_s - kShutter_s;
    sum_of_errors_s += error_s;
    sum_of_squares += std::pow(error_s / found.rolling_shutter_sigma_s, 2);
  }
  EXPECT_LT(std::abs(sum_of_errors_s) / kNumDraws, 0.02 * kShutter_s);
  EXPECT_LT(std::sqrt(sum_of_squares / kNumDraws), 1.5);
}

TEST_F(RollingShutter, SigmaContainsTheMotionOfTheCloth) {
  constexpr int kNumDraws = 12;
  constexpr double kShutter_s = 0.02;
  Stage({}, 20);
  double sum = 0.0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    std::mt19937 random(static_cast<std::uint32_t>(draw));
    std::normal_distribution<double> amplitude_m(0.0, 0.0004);
    flaps_m_.clear();
    for (std::size_t i = 0; i < scene_.frames.size(); ++i) {
      const double x = amplitude_m(random), y = amplitude_m(random), z = amplitude_m(random);
      flaps_m_.emplace_back(x, y, z);
    }
    Film(kShutter_s, 0.1, static_cast<std::uint32_t>(draw));
    const AdjustmentUncertainty found = Adjust().uncertainty;
    ASSERT_GT(found.rolling_shutter_sigma_s, 0) << draw;
    sum += std::pow((found.rolling_shutter_s - kShutter_s) / found.rolling_shutter_sigma_s, 2);
  }
  const double rms = std::sqrt(sum / kNumDraws);
  EXPECT_GT(rms, 0.5);
  EXPECT_LT(rms, 1.5);
}

// A phone held upright: the rows of its sensor are the columns of the frames.
TEST_F(RollingShutter, IsFoundInPortraitFrames) {
  Stage(TurnCamera(scene_.camera, 1));
  Film(-0.02, 0.02, 1);
  const AdjustmentUncertainty found = Adjust().uncertainty;
  EXPECT_NEAR(found.rolling_shutter_s, -0.02, 3 * found.rolling_shutter_sigma_s);
  EXPECT_LT(found.rolling_shutter_sigma_s, 0.001);
}

TEST_F(RollingShutter, IsTheOptionsWhereTheyGiveIt) {
  Film(0.02, 0, 1);
  MarkerAdjustmentOptions options;
  options.rolling_shutter_s = 0.02;
  const auto summary = Adjust(options);
  EXPECT_LT(MaxPointError(model_, truth_), 1e-4);
  EXPECT_EQ(summary.uncertainty.rolling_shutter_s, 0.02);
  EXPECT_EQ(summary.uncertainty.rolling_shutter_sigma_s, 0);
}

// A model that a frame at once shows must be the same whether it is looked for or not.
TEST_F(RollingShutter, IsNotFoundInFramesThatAreTakenAtOnce) {
  for (const std::uint32_t seed : {1U, 2U, 3U, 4U, 5U}) {
    Film(0, 0.1, seed);
    Model before = model_;
    const auto summary = Adjust();
    EXPECT_EQ(summary.uncertainty.rolling_shutter_sigma_s, 0);
    MarkerAdjustmentOptions held;
    held.estimate_rolling_shutter = false;
    AdjustWithMarkers(held, scene_.layout, corner_errors_, &before);
    EXPECT_EQ(Bytes(model_), Bytes(before));
  }
}

TEST_F(RollingShutter, IsNotLookedForWithoutFramesBeside) {
  Film(0.02, 0.05, 1);
  corner_errors_.motions.clear();
  EXPECT_EQ(Adjust().uncertainty.rolling_shutter_sigma_s, 0);
}

TEST_F(RollingShutter, LongerThanCamerasTakeIsAWarning) {
  Film(0.03, 0.05, 1);
  EXPECT_THAT(Adjust().warnings, Not(Contains(HasSubstr("stabilized"))));
  Film(0.06, 0.05, 1);
  EXPECT_THAT(Adjust().warnings, Contains(HasSubstr("stabilized")));
}

}  // namespace
}  // namespace velamap
