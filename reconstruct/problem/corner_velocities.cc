#include "reconstruct/problem/corner_velocities.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>

#include "reconstruct/registration/repeated_frames.h"

namespace velamap {
namespace {

// Over a longer time, a hand-held camera may have reversed its motion.
constexpr double kLongestStep_s = 0.15;

const MarkerDetection* FindMarker(const FrameDetections& frame, int marker_id) {
  const auto it =
      std::lower_bound(frame.markers.begin(), frame.markers.end(), marker_id,
                       [](const MarkerDetection& marker, int id) { return marker.marker_id < id; });
  return it != frame.markers.end() && it->marker_id == marker_id ? &*it : nullptr;
}

struct TimedFrame {
  const FrameDetections* detections = nullptr;
  double time_s = 0.0;
};

// The two frames before, the frame itself and the two after; null where there is none.
using FrameWindow = std::array<TimedFrame, 5>;
constexpr int kMiddle = 2;

// Weights of the values at `times_s`, one of which is 0. The weighted sum is the slope at time 0 of
// the polynomial through the values: the weights are the derivatives of Lagrange's polynomials.
Eigen::VectorXd SlopeWeights(const std::vector<double>& times_s) {
  const std::size_t size = times_s.size();
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < size; ++i) {
    double& weight = weights[static_cast<Eigen::Index>(i)];
    if (times_s[i] != 0) weight = 1 / times_s[i];
    for (std::size_t k = 0; k < size; ++k) {
      if (k == i || times_s[k] == 0) continue;
      if (times_s[i] == 0) weight -= 1 / times_s[k];
      if (times_s[i] != 0) weight *= times_s[k] / (times_s[k] - times_s[i]);
    }
  }
  return weights;
}

// The weights of `reach` frames before the middle one to `reach` after it.
Eigen::VectorXd SlopeWeights(const FrameWindow& window, int reach) {
  std::vector<double> times_s;
  for (int i = kMiddle - reach; i <= kMiddle + reach; ++i) {
    times_s.push_back(window[i].time_s - window[kMiddle].time_s);
  }
  return SlopeWeights(times_s);
}

// The velocity of the mean of a marker's corners, px/s. Velocities of single corners are twice as
// noisy, and noise in the velocities makes the estimated shutter time too short. Nothing unless all
// frames that `weights` reaches show the marker.
std::optional<Eigen::Vector2d> MeasureVelocity(const FrameWindow& window,
                                               const Eigen::VectorXd& weights, int marker_id) {
  const int reach = static_cast<int>(weights.size()) / 2;
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  for (int i = -reach; i <= reach; ++i) {
    const MarkerDetection* seen = FindMarker(*window[kMiddle + i].detections, marker_id);
    if (seen == nullptr) return std::nullopt;
    velocity += weights[reach + i] * CornerMean(*seen);
  }
  return velocity;
}

struct AffineField {
  Eigen::Vector2d center_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d value_px_s = Eigen::Vector2d::Zero();  // at the centre
  Eigen::Matrix2d gradient_1_s = Eigen::Matrix2d::Zero();

  Eigen::Vector2d At(const Eigen::Vector2d& x_in_image_px) const {
    return value_px_s + gradient_1_s * (x_in_image_px - center_px);
  }
};

// Nothing for fewer than three markers. The field does not change along an axis over which the
// markers spread by less than half a side (RMS): there it would be extrapolated to their corners,
// which multiplies the noise of the velocities.
std::optional<AffineField> FitField(const FrameDetections& frame,
                                    const std::vector<std::optional<Eigen::Vector2d>>& velocities) {
  constexpr int kMinNumMarkers = 3;
  constexpr double kMinSpread = 0.5;  // of a side
  const auto num_known = std::count_if(velocities.begin(), velocities.end(),
                                       [](const auto& velocity) { return velocity.has_value(); });
  if (num_known < kMinNumMarkers) return std::nullopt;
  Eigen::MatrixX2d places(num_known, 2), values(num_known, 2);
  Eigen::Index row = 0;
  double side_px = 0.0;
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    if (!velocities[i]) continue;
    side_px += QuadMeanSide(frame.markers[i].corners_in_image_px) / static_cast<double>(num_known);
    places.row(row) = CornerMean(frame.markers[i]).transpose();
    values.row(row++) = velocities[i]->transpose();
  }
  AffineField field;
  field.center_px = places.colwise().mean();
  field.value_px_s = values.colwise().mean();
  places.rowwise() -= field.center_px.transpose();
  values.rowwise() -= field.value_px_s.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(places.transpose() * places);
  const Eigen::Matrix2d sums = values.transpose() * places;
  const double least_sum = static_cast<double>(num_known) * std::pow(kMinSpread * side_px, 2);
  for (int i = 0; i < 2; ++i) {
    if (!(axes.eigenvalues()[i] > least_sum)) continue;
    const Eigen::Vector2d axis = axes.eigenvectors().col(i);
    field.gradient_1_s += sums * axis * axis.transpose() / axes.eigenvalues()[i];
  }
  return field;
}

// What the sensor has seen at one time, and the frames that show it: one, and those that repeat it.
struct Exposure {
  double time_s = 0.0;
  std::vector<const DatabaseImage*> frames;
};

// In the order of time. Photographs are left out.
std::vector<Exposure> ExposuresOf(const std::vector<DatabaseImage>& images) {
  std::vector<const DatabaseImage*> frames;
  for (const DatabaseImage& image : images) {
    if (image.detections.time_s) frames.push_back(&image);
  }
  std::sort(frames.begin(), frames.end(), [](const DatabaseImage* a, const DatabaseImage* b) {
    return *a->detections.time_s < *b->detections.time_s;
  });
  const std::vector<bool> is_repeated = FindRepeatedFrames(frames);
  std::vector<Exposure> exposures;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!is_repeated[i]) exposures.push_back({*frames[i]->detections.time_s, {}});
    exposures.back().frames.push_back(frames[i]);
  }
  return exposures;
}

// The axis of the image along which the rows of a sensor follow each other. Sensors are wider than
// high, so portrait frames are turned and show the sensor's rows as columns.
int ReadoutAxis(const Camera& camera) { return camera.height_px > camera.width_px ? 0 : 1; }

// Size of the image along that axis.
double ReadoutSizePx(const Camera& camera) { return std::min(camera.width_px, camera.height_px); }

// Empty where the neighbouring frames show too few markers.
std::vector<Eigen::Vector2d> VelocitiesOf(const FrameWindow& window) {
  const FrameDetections& frame = *window[kMiddle].detections;
  std::vector<std::optional<Eigen::Vector2d>> measured;
  const Eigen::VectorXd narrow = SlopeWeights(window, 1);
  const bool is_wide = window.front().detections != nullptr && window.back().detections != nullptr;
  const Eigen::VectorXd wide = is_wide ? SlopeWeights(window, kMiddle) : narrow;
  for (const MarkerDetection& marker : frame.markers) {
    auto velocity = MeasureVelocity(window, wide, marker.marker_id);
    if (!velocity && is_wide) velocity = MeasureVelocity(window, narrow, marker.marker_id);
    measured.push_back(velocity);
  }
  const std::optional<AffineField> field = FitField(frame, measured);
  std::vector<Eigen::Vector2d> velocities;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!measured[i] && !field) return {};
    const MarkerDetection& marker = frame.markers[i];
    for (const Eigen::Vector2d& x_in_image_px : marker.corners_in_image_px) {
      // Within a marker, the field says how the velocity changes.
      Eigen::Vector2d velocity = field ? field->At(x_in_image_px) : *measured[i];
      if (field && measured[i]) velocity += *measured[i] - field->At(CornerMean(marker));
      velocities.push_back(velocity);
    }
  }
  return velocities;
}

// Adds `factor` times ShutterDirection to the image points whose velocities are known.
template <typename Factor>
void AddShutter(const CornerVelocities& velocities_px_s, const Factor& factor, Model* model) {
  for (ModelImage& image : model->images) {
    const auto velocities = velocities_px_s.find(image.image_id);
    if (velocities == velocities_px_s.end()) continue;
    const Camera& camera = model->cameras.at(image.camera_id);
    for (std::size_t i = 0; i < image.points2D.size(); ++i) {
      Eigen::Vector2d& x_px = image.points2D[i].x_in_image_px;
      const Eigen::Vector2d& velocity_px_s = velocities->second.at(i);
      x_px += factor(camera, velocity_px_s) * ShutterDirection(camera, x_px, velocity_px_s);
    }
  }
}

}  // namespace

CornerVelocities CornerVelocitiesOf(const std::vector<DatabaseImage>& images) {
  const std::vector<Exposure> exposures = ExposuresOf(images);
  const auto are_near = [&](std::size_t i, std::size_t k) {
    const double step_s = exposures[k].time_s - exposures[i].time_s;
    return step_s > 0 && step_s <= kLongestStep_s &&
           exposures[i].frames.front()->camera_id == exposures[k].frames.front()->camera_id;
  };
  const auto timed = [&](std::size_t i) {
    return TimedFrame{&exposures[i].frames.front()->detections, exposures[i].time_s};
  };
  CornerVelocities velocities;
  for (std::size_t i = 1; i + 1 < exposures.size(); ++i) {
    if (!are_near(i - 1, i) || !are_near(i, i + 1)) continue;
    FrameWindow window{TimedFrame{}, timed(i - 1), timed(i), timed(i + 1), TimedFrame{}};
    if (i >= 2 && are_near(i - 2, i - 1)) window.front() = timed(i - 2);
    if (i + 2 < exposures.size() && are_near(i + 1, i + 2)) window.back() = timed(i + 2);
    for (const DatabaseImage* frame : exposures[i].frames) {
      window[kMiddle].detections = &frame->detections;
      std::vector<Eigen::Vector2d> of_image = VelocitiesOf(window);
      if (!of_image.empty()) velocities[frame->image_id] = std::move(of_image);
    }
  }
  return velocities;
}

Eigen::Vector2d ShutterDirection(const Camera& camera, const Eigen::Vector2d& x_in_image_px,
                                 const Eigen::Vector2d& velocity_px_s) {
  return (x_in_image_px[ReadoutAxis(camera)] / ReadoutSizePx(camera) - 0.5) * velocity_px_s;
}

void MoveToMiddleRow(double rolling_shutter_s, const CornerVelocities& velocities_px_s,
                     Model* model) {
  if (rolling_shutter_s == 0) return;
  AddShutter(
      velocities_px_s, [&](const Camera&, const Eigen::Vector2d&) { return -rolling_shutter_s; },
      model);
}

void MoveFromMiddleRow(double rolling_shutter_s, const CornerVelocities& velocities_px_s,
                       Model* model) {
  if (rolling_shutter_s == 0) return;
  // MoveToMiddleRow scales a point's distance from the middle row, and so its ShutterDirection, by
  // this factor; the inverse has to divide by it.
  const auto scale = [&](const Camera& camera, const Eigen::Vector2d& velocity_px_s) {
    return 1.0 - rolling_shutter_s * velocity_px_s[ReadoutAxis(camera)] / ReadoutSizePx(camera);
  };
  AddShutter(
      velocities_px_s,
      [&](const Camera& camera, const Eigen::Vector2d& velocity_px_s) {
        return rolling_shutter_s / scale(camera, velocity_px_s);
      },
      model);
}

}  // namespace velamap
