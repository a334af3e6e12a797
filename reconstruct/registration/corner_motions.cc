#include "reconstruct/registration/corner_motions.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/LU>

#include "reconstruct/registration/motion_field.h"
#include "reconstruct/registration/repeated_frames.h"

namespace velamap {
namespace {

// Over a longer time, a hand-held camera may have reversed its motion.
constexpr double kLongestStep_s = 0.15;

struct TimedFrame {
  const FrameDetections* detections = nullptr;
  double time_s = 0.0;  // after the frame whose corners' motions are sought
};

// That frame and those around it, in the order of time.
using FrameWindow = std::vector<TimedFrame>;

// Weights of the values at these times, one of which is 0. The sums weighted by the columns are the
// first and the second derivative at time 0 of the polynomial through the values.
Eigen::MatrixX2d DerivativeWeights(const std::vector<double>& times_s) {
  const auto size = static_cast<Eigen::Index>(times_s.size());
  const double unit_s = times_s.back() - times_s.front();
  const Eigen::ArrayXd times = Eigen::Map<const Eigen::ArrayXd>(times_s.data(), size) / unit_s;
  Eigen::MatrixXd powers(size, size);
  for (Eigen::Index power = 0; power < size; ++power)
    powers.row(power) = times.pow(static_cast<double>(power)).matrix().transpose();
  Eigen::MatrixX2d derivatives = Eigen::MatrixX2d::Zero(size, 2);
  derivatives(1, 0) = 1 / unit_s;
  derivatives(2, 1) = 2 / (unit_s * unit_s);
  return powers.partialPivLu().solve(derivatives);
}

// Where the mean of a marker's corners is, and when.
struct Sighting {
  double time_s = 0.0;
  Eigen::Vector2d place_px;
};

// The sightings that give a marker's motion: in the nearest frames of the window that show it,
// before and after. One side has at most one more than the other, because a polynomial through
// frames of one side is several times as noisy. At the end of a marker's visibility, these are the
// frame itself and the next two.
std::vector<Sighting> SightingsOf(const FrameWindow& window, int marker_id) {
  std::vector<Sighting> all;
  std::ptrdiff_t num_before = 0;
  for (const TimedFrame& frame : window) {
    const MarkerDetection* seen = FindMarkerById(frame.detections->markers, marker_id);
    if (seen == nullptr) continue;
    all.push_back({frame.time_s, CornerMean(*seen)});
    if (frame.time_s < 0) ++num_before;
  }
  const std::ptrdiff_t num_after = static_cast<std::ptrdiff_t>(all.size()) - num_before - 1;
  const std::ptrdiff_t reach = std::max<std::ptrdiff_t>(2, std::min(num_before, num_after) + 1);
  const auto middle = all.begin() + num_before;
  return {middle - std::min(reach, num_before), middle + 1 + std::min(reach, num_after)};
}

// The motion of the mean of a marker's corners. Motions of single corners are twice as noisy, and
// noise in the velocities makes the estimated shutter time too short. Nothing unless the marker is
// seen in three frames and, where there are such, before and after this one.
std::optional<MotionVector> MeasureMotion(const FrameWindow& window, int marker_id) {
  constexpr std::size_t kMinNumFrames = 3;
  const std::vector<Sighting> sightings = SightingsOf(window, marker_id);
  if (sightings.size() < kMinNumFrames) return std::nullopt;
  std::vector<double> times_s;
  Eigen::Matrix2Xd places(2, static_cast<Eigen::Index>(sightings.size()));
  for (const Sighting& sighting : sightings) {
    places.col(static_cast<Eigen::Index>(times_s.size())) = sighting.place_px;
    times_s.push_back(sighting.time_s);
  }
  const auto is_between = [](double first_s, double last_s) { return first_s < 0 && last_s > 0; };
  if (is_between(window.front().time_s, window.back().time_s) &&
      !is_between(times_s.front(), times_s.back())) {
    return std::nullopt;
  }
  const Eigen::Matrix2d derivatives = places * DerivativeWeights(times_s);
  return MotionVector(derivatives.reshaped());
}

// Nothing for fewer than three markers.
std::optional<MotionField> FitField(const FrameDetections& frame,
                                    const std::vector<std::optional<MotionVector>>& measured) {
  constexpr std::size_t kMinNumMarkers = 3;
  std::vector<PlacedMotion> motions;
  double sum_of_sides_px = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!measured[i]) continue;
    motions.push_back({CornerMean(frame.markers[i]), *measured[i]});
    sum_of_sides_px += QuadMeanSide(frame.markers[i].corners_in_image_px);
  }
  if (motions.size() < kMinNumMarkers) return std::nullopt;
  return MotionField(motions, sum_of_sides_px / static_cast<double>(motions.size()));
}

// Empty where the neighbouring frames show too few markers.
std::vector<CornerMotion> MotionsOf(const FrameDetections& frame, const FrameWindow& window) {
  std::vector<std::optional<MotionVector>> measured;
  for (const MarkerDetection& marker : frame.markers) {
    measured.push_back(MeasureMotion(window, marker.marker_id));
  }
  const std::optional<MotionField> field = FitField(frame, measured);
  std::vector<CornerMotion> motions;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!measured[i] && !field) return {};
    const MarkerDetection& marker = frame.markers[i];
    for (const Eigen::Vector2d& x_in_image_px : marker.corners_in_image_px) {
      MotionVector motion = field ? field->At(x_in_image_px) : *measured[i];
      // Within a marker, the field says how the velocity changes. Accelerations are too noisy for
      // more than the field.
      if (field && measured[i]) {
        motion.head<2>() += (*measured[i] - field->At(CornerMean(marker))).head<2>();
      }
      motions.push_back({motion.head<2>(), motion.tail<2>()});
    }
  }
  return motions;
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

// The frames within `reach` exposures of exposure `idx`, none more than kLongestStep_s from the
// next.
FrameWindow WindowAround(const std::vector<Exposure>& exposures, std::size_t idx,
                         std::size_t reach) {
  const auto are_near = [&](std::size_t i) {  // this one and the next
    const double step_s = exposures[i + 1].time_s - exposures[i].time_s;
    return step_s > 0 && step_s <= kLongestStep_s &&
           exposures[i].frames.front()->camera_id == exposures[i + 1].frames.front()->camera_id;
  };
  std::size_t begin = idx, end = idx + 1;
  while (begin > 0 && begin + reach > idx && are_near(begin - 1)) --begin;
  while (end < exposures.size() && end <= idx + reach && are_near(end - 1)) ++end;
  FrameWindow window;
  for (std::size_t i = begin; i < end; ++i) {
    window.push_back(
        {&exposures[i].frames.front()->detections, exposures[i].time_s - exposures[idx].time_s});
  }
  return window;
}

// As many frames as it takes to follow a hand that trembles at 6 Hz; more would only add noise.
FrameWindow WindowAround(const std::vector<Exposure>& exposures, std::size_t idx) {
  constexpr double kSlow_s = 0.025;  // mean step from frame to frame
  FrameWindow window = WindowAround(exposures, idx, 2);
  const double span_s = window.back().time_s - window.front().time_s;
  const bool is_slow = span_s > kSlow_s * static_cast<double>(window.size() - 1);
  return is_slow ? WindowAround(exposures, idx, 4) : window;
}

}  // namespace

CornerMotions CornerMotionsOf(const std::vector<DatabaseImage>& images) {
  const std::vector<Exposure> exposures = ExposuresOf(images);
  CornerMotions motions;
  for (std::size_t i = 0; i < exposures.size(); ++i) {
    FrameWindow window = WindowAround(exposures, i);
    for (const DatabaseImage* frame : exposures[i].frames) {
      for (TimedFrame& timed : window) {
        if (timed.time_s == 0) timed.detections = &frame->detections;
      }
      std::vector<CornerMotion> of_image = MotionsOf(frame->detections, window);
      if (!of_image.empty()) motions[frame->image_id] = std::move(of_image);
    }
  }
  return motions;
}

}  // namespace velamap
