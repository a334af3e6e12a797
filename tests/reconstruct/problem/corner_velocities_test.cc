#include "reconstruct/problem/corner_velocities.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "importer/base/statistics.h"
#include "importer/camera/turned_camera.h"

namespace velamap {
namespace {

using testing::IsEmpty;
using testing::Key;
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

void ExpectField(const FrameDetections& photograph, const std::vector<Eigen::Vector2d>& found) {
  ASSERT_EQ(found.size(), kNumCorners * photograph.markers.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::Vector2d& x_px =
        photograph.markers[i / kNumCorners].corners_in_image_px[i % kNumCorners];
    EXPECT_LT((found[i] - FieldVelocity(x_px)).norm(), 1e-9);
  }
}

TEST(CornerVelocities, AreFoundFromTheFramesBesideInAnyOrder) {
  const FrameDetections photograph = Photograph(8);
  std::vector<DatabaseImage> frames = {FrameAt(-1.0 / 30, 5, photograph), FrameAt(0, 2, photograph),
                                       FrameAt(1.0 / 24, 9, photograph)};
  std::mt19937 random(1);
  for (int i = 0; i < 4; ++i) {
    const CornerVelocities velocities = CornerVelocitiesOf(frames);
    ASSERT_THAT(velocities, UnorderedElementsAre(Key(2)));  // the others are first and last
    ExpectField(photograph, velocities.at(2));
    std::shuffle(frames.begin(), frames.end(), random);
  }
}

// A shake of 3 Hz, filmed at 30 Hz, frames now and then late.
TEST(CornerVelocities, FollowAFastShake) {
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
  const auto middle = CornerVelocitiesOf(frames).at(3);
  const auto between_two = CornerVelocitiesOf({frames[1], frames[2], frames[3]}).at(3);
  for (std::size_t i = 0; i < middle.size(); ++i) {
    EXPECT_NEAR(middle[i].x() / expected_px_s, 1, 0.01);
    EXPECT_NEAR(middle[i].y(), 0, 1e-9);
    EXPECT_LT(between_two[i].x() / expected_px_s, 0.95);
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

TEST(CornerVelocities, AreRightWhereFramesAreRepeated) {
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
    const CornerVelocities velocities = CornerVelocitiesOf(ClipOf(times_s, &random));
    EXPECT_GE(velocities.size(), kNumFrames - 6u);
    for (const auto& [image_id, found_px_s] : velocities) {
      for (std::size_t i = 0; i < found_px_s.size(); ++i) {
        const Eigen::Vector2d expected_px_s =
            FieldVelocity(photograph.markers[i / kNumCorners].corners_in_image_px[i % kNumCorners]);
        EXPECT_LT((found_px_s[i] - expected_px_s).norm(), kTolerance_px_s) << image_id;
      }
    }
  }
}

TEST(CornerVelocities, MarkersThatAreMissingBesideMoveWithTheirNeighbours) {
  const FrameDetections photograph = Photograph(8);
  std::vector<DatabaseImage> frames = {FrameAt(-0.03, 1, photograph), FrameAt(0, 2, photograph),
                                       FrameAt(0.03, 3, photograph)};
  RemoveMarker(6, &frames[0]);
  RemoveMarker(2, &frames[2]);
  const CornerVelocities velocities = CornerVelocitiesOf(frames);
  ASSERT_THAT(velocities, UnorderedElementsAre(Key(2)));
  ExpectField(photograph, velocities.at(2));
}

// A row that is not quite straight tells nothing of how the velocity changes across it.
TEST(CornerVelocities, AcrossANearlyStraightRowNoiseIsNotExtrapolated) {
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
    const CornerVelocities velocities = CornerVelocitiesOf(frames);
    for (const Eigen::Vector2d& velocity_px_s : velocities.at(2)) {
      errors_px_s.push_back(velocity_px_s.x() - 40);
      errors_px_s.push_back(velocity_px_s.y() + 25);
    }
  }
  // Of the mean of four corners in two frames. The gradient along the row adds little.
  const double sigma_px_s = kCornerNoisePx / 2 * std::sqrt(2.0) / (2 * kStep_s);
  EXPECT_LT(Rms(errors_px_s), 1.1 * sigma_px_s);
}

TEST(CornerVelocities, AreUnknownWhereTheFramesBesideTellNothing) {
  const FrameDetections photograph = Photograph(3);
  EXPECT_THAT(CornerVelocitiesOf({}), IsEmpty());
  EXPECT_THAT(CornerVelocitiesOf({{1, 1, photograph}, {2, 1, photograph}, {3, 1, photograph}}),
              IsEmpty());
  const DatabaseImage middle = FrameAt(0, 2, photograph);
  const DatabaseImage before = FrameAt(-0.1, 1, photograph), after = FrameAt(0.1, 3, photograph);
  EXPECT_EQ(CornerVelocitiesOf({before, middle, after}).size(), 1u);
  EXPECT_THAT(CornerVelocitiesOf({before, middle}), IsEmpty());
  EXPECT_THAT(CornerVelocitiesOf({before, middle, FrameAt(0.2, 3, photograph)}), IsEmpty());
  EXPECT_THAT(CornerVelocitiesOf({before, middle, FrameAt(0, 3, photograph)}), IsEmpty());
  DatabaseImage other_camera = after;
  other_camera.camera_id = 2;
  EXPECT_THAT(CornerVelocitiesOf({before, middle, other_camera}), IsEmpty());
  DatabaseImage two_markers = before;
  RemoveMarker(1, &two_markers);  // two are too few for a field
  EXPECT_THAT(CornerVelocitiesOf({two_markers, middle, after}), IsEmpty());
}

TEST(CornerVelocities, PointsMoveToTheMiddleRow) {
  Model model;
  model.cameras[1] = {CameraModel::kSimplePinhole, 640, 480, {500, 320, 240}};
  ModelImage image;
  image.image_id = 7;
  image.camera_id = 1;
  for (const double y : {0.0, 240.0, 480.0}) image.points2D.push_back({{100, y}, 0});
  model.images = {image, image};
  model.images[1].image_id = 8;
  MoveToMiddleRow(0.02, {{7, {{50, 100}, {50, 100}, {50, 100}}}}, &model);
  const auto x_px = [&](int image_idx, int i) -> Eigen::Vector2d {
    return model.images[image_idx].points2D[i].x_in_image_px;
  };
  // Half the time before and after the middle row.
  EXPECT_LT((x_px(0, 0) - Eigen::Vector2d(100.5, 1)).norm(), 1e-12);
  EXPECT_EQ(x_px(0, 1), Eigen::Vector2d(100, 240));
  EXPECT_LT((x_px(0, 2) - Eigen::Vector2d(99.5, 479)).norm(), 1e-12);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(x_px(1, i), image.points2D[i].x_in_image_px);
}

TEST(CornerVelocities, PortraitFramesAreReadColumnByColumn) {
  const Camera landscape{CameraModel::kSimplePinhole, 640, 480, {500, 320, 240}};
  const Camera portrait = TurnCamera(landscape, 1);
  const Eigen::Vector2d x_px(100, 30), velocity_px_s(70, -20);
  const Eigen::Vector2d turned_px = TurnInImage(landscape, 1, x_px);
  const Eigen::Vector2d turned_velocity_px_s =
      TurnInImage(landscape, 1, x_px + velocity_px_s) - turned_px;
  // Turned clockwise, the first row of the sensor is the last column.
  const Eigen::Vector2d shift_px = -ShutterDirection(portrait, turned_px, turned_velocity_px_s);
  const Eigen::Vector2d expected_px =
      TurnInImage(landscape, 1, x_px + ShutterDirection(landscape, x_px, velocity_px_s)) -
      turned_px;
  EXPECT_LT((shift_px - expected_px).norm(), 1e-12);
}

TEST(CornerVelocities, WayBackFromTheMiddleRowIsExact) {
  Model model;
  model.cameras[1] = {CameraModel::kSimplePinhole, 640, 480, {500, 320, 240}};
  ModelImage image;
  image.image_id = 7;
  image.camera_id = 1;
  CornerVelocities velocities;
  for (const double y : {-5.0, 0.0, 130.0, 240.0, 475.0}) {
    for (const double velocity_px_s : {-3000.0, 0.0, 40.0, 3000.0}) {
      image.points2D.push_back({{100, y}, 0});
      velocities[7].emplace_back(700, velocity_px_s);
    }
  }
  model.images = {image};
  const auto largest_shift_px = [&] {
    double largest = 0.0;
    for (std::size_t i = 0; i < image.points2D.size(); ++i) {
      const Eigen::Vector2d shift =
          model.images[0].points2D[i].x_in_image_px - image.points2D[i].x_in_image_px;
      largest = std::max(largest, shift.norm());
    }
    return largest;
  };
  for (const double rolling_shutter_s : {-0.03, 0.03}) {
    MoveToMiddleRow(rolling_shutter_s, velocities, &model);
    EXPECT_GT(largest_shift_px(), 40);
    MoveFromMiddleRow(rolling_shutter_s, velocities, &model);
    EXPECT_LT(largest_shift_px(), 1e-9);
  }
}

}  // namespace
}  // namespace velamap
