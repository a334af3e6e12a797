#include "reconstruct/registration/corner_motions.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::Key;
using testing::Not;
using testing::UnorderedElementsAre;

// Markers whose corners move as an affine field, px/s.
Eigen::Vector2d FieldVelocity(const Eigen::Vector2d& x_px) {
  return {120 - 0.2 * x_px.x() + 0.1 * x_px.y(), -80 + 0.05 * x_px.x() + 0.3 * x_px.y()};
}

FrameDetections Photograph(int num_markers) {
  FrameDetections photograph;
  for (int k = 0; k < num_markers; ++k) {
    MarkerDetection marker;
    marker.marker_id = 3 * k;
    const Eigen::Vector2d middle(150 * (k % 4) + 100, 170 * (k / 4) + 90);
    marker.corners_in_image_px = {
        middle + Eigen::Vector2d(-20, -20), middle + Eigen::Vector2d(20, -20),
        middle + Eigen::Vector2d(20, 20), middle + Eigen::Vector2d(-20, 20)};
    photograph.markers.push_back(marker);
  }
  return photograph;
}

// The photograph's corners as they are at `time_s`.
DatabaseImage FrameAt(double time_s, ImageId image_id, const FrameDetections& photograph) {
  DatabaseImage frame{image_id, 1, photograph};
  frame.detections.time_s = time_s;
  for (MarkerDetection& marker : frame.detections.markers) {
    for (Eigen::Vector2d& x_px : marker.corners_in_image_px) x_px += time_s * FieldVelocity(x_px);
  }
  return frame;
}

void RemoveMarker(int idx, DatabaseImage* frame) {
  frame->detections.markers.erase(frame->detections.markers.begin() + idx);
}

void ExpectField(const FrameDetections& photograph, const std::vector<CornerMotion>& found) {
  ASSERT_EQ(found.size(), kNumCorners * photograph.markers.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::Vector2d& x_px =
        photograph.markers[i / kNumCorners].corners_in_image_px[i % kNumCorners];
    EXPECT_LT((found[i].velocity_px_s - FieldVelocity(x_px)).norm(), 1e-9);
    EXPECT_LT(found[i].acceleration_px_s2.norm(), 1e-6);
  }
}

TEST(CornerMotions, AreFoundFromTheFramesAroundInAnyOrder) {
  const FrameDetections photograph = Photograph(8);
  std::vector<DatabaseImage> frames = {FrameAt(-1.0 / 30, 5, photograph), FrameAt(0, 2, photograph),
                                       FrameAt(1.0 / 24, 9, photograph)};
  std::mt19937 random(1);
  for (int i = 0; i < 4; ++i) {
    const CornerMotions motions = CornerMotionsOf(frames);
    ASSERT_THAT(motions, UnorderedElementsAre(Key(5), Key(2), Key(9)));
    for (const auto& [image_id, of_image] : motions) ExpectField(photograph, of_image);
    std::shuffle(frames.begin(), frames.end(), random);
  }
}

// A shake of 3 Hz, filmed at 30 Hz, frames now and then late.
TEST(CornerMotions, FollowAFastShake) {
  const FrameDetections photograph = Photograph(4);
  const double turn_rad_s = 2 * 3.14159265358979 * 3;
  std::vector<DatabaseImage> frames;
  for (const double time_s : {-0.070, -0.033, 0.0, 0.034, 0.066}) {
    DatabaseImage frame{static_cast<ImageId>(frames.size() + 1), 1, photograph};
    frame.detections.time_s = 5 + time_s;
    for (MarkerDetection& marker : frame.detections.markers) {
      for (Eigen::Vector2d& x_px : marker.corners_in_image_px) {
        x_px.x() += 10 * std::sin(turn_rad_s * time_s + 0.5);
      }
    }
    frames.push_back(frame);
  }
  const double expected_px_s = 10 * turn_rad_s * std::cos(0.5);
  const double expected_px_s2 = -10 * turn_rad_s * turn_rad_s * std::sin(0.5);
  const auto middle = CornerMotionsOf(frames).at(3);
  const auto between_two = CornerMotionsOf({frames[1], frames[2], frames[3]}).at(3);
  for (std::size_t i = 0; i < middle.size(); ++i) {
    EXPECT_NEAR(middle[i].velocity_px_s.x() / expected_px_s, 1, 0.01);
    EXPECT_NEAR(middle[i].acceleration_px_s2.x() / expected_px_s2, 1, 0.02);
    EXPECT_NEAR(middle[i].velocity_px_s.y(), 0, 1e-9);
    EXPECT_LT(between_two[i].velocity_px_s.x() / expected_px_s, 0.95);
  }
}

// A hand that trembles at 6 Hz, filmed at 25 Hz.
TEST(CornerMotions, FollowATremblingHand) {
  const FrameDetections photograph = Photograph(4);
  const double turn_rad_s = 2 * 3.14159265358979 * 6;
  std::vector<DatabaseImage> frames;
  for (int i = -6; i <= 6; ++i) {
    DatabaseImage frame{static_cast<ImageId>(10 + i), 1, photograph};
    frame.detections.time_s = i / 25.0;
    for (MarkerDetection& marker : frame.detections.markers) {
      for (Eigen::Vector2d& x_px : marker.corners_in_image_px) {
        x_px.y() += 10 * std::sin(turn_rad_s * i / 25.0 + 0.5);
      }
    }
    frames.push_back(frame);
  }
  const double expected_px_s = 10 * turn_rad_s * std::cos(0.5);
  const CornerMotions motions = CornerMotionsOf(frames);
  for (const CornerMotion& motion : motions.at(10)) {
    EXPECT_NEAR(motion.velocity_px_s.y() / expected_px_s, 1, 0.03);
  }
}

// A clip at 60 Hz whose frames show the field at `times_s`, with the noise that compression adds to
// a repeated frame.
std::vector<DatabaseImage> ClipOf(const std::vector<double>& times_s, std::mt19937* random) {
  const FrameDetections photograph = Photograph(6);
  std::normal_distribution<double> noise_px(0.0, 0.01);
  std::vector<DatabaseImage> frames;
  for (const double time_s : times_s) {
    frames.push_back(FrameAt(time_s, static_cast<ImageId>(frames.size() + 1), photograph));
    frames.back().detections.time_s = static_cast<double>(frames.size() - 1) / 60;
    for (MarkerDetection& marker : frames.back().detections.markers) {
      for (Eigen::Vector2d& x_px : marker.corners_in_image_px) {
        x_px += Eigen::Vector2d(noise_px(*random), noise_px(*random));
      }
    }
  }
  return frames;
}

TEST(CornerMotions, AreRightWhereFramesAreRepeated) {
  constexpr int kNumFrames = 30;
  constexpr double kTolerance_px_s = 2.0;  // of 80 to 170
  const FrameDetections photograph = Photograph(6);
  std::mt19937 random(7);
  // One frame in eight is dropped, or every second or two of three are repeated.
  for (const int num_shown : {0, 2, 3}) {
    std::vector<double> times_s;
    std::bernoulli_distribution is_dropped(0.125);
    for (int i = 0; i < kNumFrames; ++i) {
      const bool is_new = num_shown == 0 ? i == 0 || !is_dropped(random) : i % num_shown == 0;
      times_s.push_back(is_new ? i / 60.0 : times_s.back());
    }
    const CornerMotions motions = CornerMotionsOf(ClipOf(times_s, &random));
    EXPECT_EQ(motions.size(), kNumFrames);
    for (const auto& [image_id, found] : motions) {
      // The first and the last picture have others on one side only.
      const double time_s = times_s[image_id - 1];
      const bool is_at_end = time_s == times_s.front() || time_s == times_s.back();
      for (std::size_t i = 0; i < found.size(); ++i) {
        const Eigen::Vector2d expected_px_s =
            FieldVelocity(photograph.markers[i / kNumCorners].corners_in_image_px[i % kNumCorners]);
        EXPECT_LT((found[i].velocity_px_s - expected_px_s).norm(),
                  is_at_end ? 4 * kTolerance_px_s : kTolerance_px_s)
            << image_id;
      }
    }
  }
}

// RMS error of the velocities in a clip of a hand that shakes at up to 9 Hz, which shows each
// marker in `share` of the frames; and the mean of the sigmas over it.
struct ShakyClip {
  double rms_px_s = 0.0, mean_sigma_px_s = 0.0;
};

ShakyClip MeasureShakyClip(double share) {
  constexpr int kNumFrames = 60, kAtEnd = 4;
  constexpr double kFrequencies_Hz[] = {0.4, 0.7, 1.3, 2.3, 4.1, 6.0, 9.0};
  std::mt19937 random(11);
  std::normal_distribution<double> noise_px(0.0, 0.1);
  std::bernoulli_distribution is_seen(share);
  const FrameDetections photograph = Photograph(24);
  std::vector<DatabaseImage> frames;
  std::vector<double> expected_px_s;
  for (int i = 0; i < kNumFrames; ++i) {
    const double time_s = i / 30.0;
    double shift_px = 0.0, velocity_px_s = 0.0;
    for (const double frequency_Hz : kFrequencies_Hz) {
      const double turn_rad_s = 2 * 3.14159265358979 * frequency_Hz;
      shift_px += 40 / turn_rad_s * std::sin(turn_rad_s * time_s + turn_rad_s);
      velocity_px_s += 40 * std::cos(turn_rad_s * time_s + turn_rad_s);
    }
    expected_px_s.push_back(velocity_px_s);
    DatabaseImage frame{static_cast<ImageId>(i + 1), 1, photograph};
    frame.detections.time_s = time_s;
    frame.detections.markers.clear();
    for (MarkerDetection marker : photograph.markers) {
      if (!is_seen(random)) continue;
      for (Eigen::Vector2d& x_px : marker.corners_in_image_px) {
        x_px += Eigen::Vector2d(shift_px + noise_px(random), noise_px(random));
      }
      frame.detections.markers.push_back(marker);
    }
    frames.push_back(std::move(frame));
  }
  std::vector<double> errors_px_s;
  ShakyClip clip;
  for (const auto& [image_id, found] : CornerMotionsOf(frames)) {
    if (image_id <= kAtEnd || image_id > kNumFrames - kAtEnd) continue;
    for (const CornerMotion& motion : found) {
      errors_px_s.push_back(motion.velocity_px_s.x() - expected_px_s[image_id - 1]);
      clip.mean_sigma_px_s += motion.velocity_sigma_px_s;
    }
  }
  clip.rms_px_s = Rms(errors_px_s);
  clip.mean_sigma_px_s /= static_cast<double>(errors_px_s.size());
  return clip;
}

// A marker whose neighbouring frames are missing does not show a shake as the others do.
TEST(CornerMotions, OfMarkersThatSomeFramesLackFollowTheOthers) {
  const ShakyClip whole = MeasureShakyClip(1.0), gappy = MeasureShakyClip(0.6);
  EXPECT_LT(gappy.rms_px_s, 2 * whole.rms_px_s);
  EXPECT_LT(gappy.rms_px_s, 2 * gappy.mean_sigma_px_s);
  EXPECT_GT(gappy.rms_px_s, 0.5 * gappy.mean_sigma_px_s);
}

TEST(CornerMotions, MarkersThatAreMissingBesideMoveWithTheirNeighbours) {
  const FrameDetections photograph = Photograph(8);
  std::vector<DatabaseImage> frames = {FrameAt(-0.03, 1, photograph), FrameAt(0, 2, photograph),
                                       FrameAt(0.03, 3, photograph)};
  RemoveMarker(6, &frames[0]);
  RemoveMarker(2, &frames[2]);
  const CornerMotions motions = CornerMotionsOf(frames);
  ExpectField(photograph, motions.at(2));
}

// A row that is not quite straight tells nothing of how the velocity changes across it.
TEST(CornerMotions, AcrossANearlyStraightRowNoiseIsNotExtrapolated) {
  constexpr double kCornerNoisePx = 0.1, kStep_s = 0.03;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> errors_px_s;
  for (int draw = 0; draw < 50; ++draw) {
    FrameDetections photograph;
    for (int k = 0; k < 6; ++k) {
      photograph.markers.push_back(Photograph(1).markers[0]);
      photograph.markers.back().marker_id = k;
      const Eigen::Vector2d shift(150 * k, 2 * normal(random));
      for (Eigen::Vector2d& x_px : photograph.markers.back().corners_in_image_px) x_px += shift;
    }
    std::vector<DatabaseImage> frames;
    for (const double time_s : {-kStep_s, 0.0, kStep_s}) {
      frames.push_back({static_cast<ImageId>(frames.size() + 1), 1, photograph});
      frames.back().detections.time_s = time_s;
      for (MarkerDetection& marker : frames.back().detections.markers) {
        for (Eigen::Vector2d& x_px : marker.corners_in_image_px) {
          x_px += Eigen::Vector2d(40 * time_s + kCornerNoisePx * normal(random),
                                  -25 * time_s + kCornerNoisePx * normal(random));
        }
      }
    }
    const CornerMotions motions = CornerMotionsOf(frames);
    for (const CornerMotion& motion : motions.at(2)) {
      errors_px_s.push_back(motion.velocity_px_s.x() - 40);
      errors_px_s.push_back(motion.velocity_px_s.y() + 25);
    }
  }
  // Of the mean of four corners in two frames. The gradient along the row adds little.
  const double sigma_px_s = kCornerNoisePx / 2 * std::sqrt(2.0) / (2 * kStep_s);
  EXPECT_LT(Rms(errors_px_s), 1.1 * sigma_px_s);
}

TEST(CornerMotions, AreUnknownWhereTheFramesBesideTellNothing) {
  const FrameDetections photograph = Photograph(3);
  EXPECT_THAT(CornerMotionsOf({}), IsEmpty());
  EXPECT_THAT(CornerMotionsOf({{1, 1, photograph}, {2, 1, photograph}, {3, 1, photograph}}),
              IsEmpty());
  const DatabaseImage middle = FrameAt(0, 2, photograph);
  const DatabaseImage before = FrameAt(-0.1, 1, photograph), after = FrameAt(0.1, 3, photograph);
  EXPECT_EQ(CornerMotionsOf({before, middle, after}).size(), 3u);
  EXPECT_THAT(CornerMotionsOf({before, middle}), IsEmpty());
  EXPECT_THAT(CornerMotionsOf({before, middle, FrameAt(0.2, 3, photograph)}), IsEmpty());
  EXPECT_THAT(CornerMotionsOf({before, middle, FrameAt(0, 3, photograph)}), IsEmpty());
  DatabaseImage other_camera = after;
  other_camera.camera_id = 2;
  EXPECT_THAT(CornerMotionsOf({before, middle, other_camera}), IsEmpty());
  DatabaseImage two_markers = before;
  RemoveMarker(1, &two_markers);  // two are too few for a field
  EXPECT_THAT(CornerMotionsOf({two_markers, middle, after}), Not(Contains(Key(2))));
}

}  // namespace
}  // namespace velamap
