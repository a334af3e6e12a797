#include "reconstruct/registration/corner_motions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "reconstruct/registration/frame_window.h"
#include "reconstruct/registration/motion_field.h"
#include "reconstruct/registration/track_smoothing.h"

namespace velamap {
namespace {

// Number of frames before and after a frame that contribute to the motion of its corners. More
// distant ones would add noise, or motion that is unrelated to that in this frame.
constexpr std::size_t kReach = 8;

using RowMajorTracks = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The weights of places at the same times are the same for all markers of a frame.
class PlaceWeights {
 public:
  explicit PlaceWeights(const TrackModel& model) : model_(model) {}

  const DerivativeWeights& At(const std::vector<double>& times_s) {
    auto known = by_times_.find(times_s);
    if (known == by_times_.end()) {
      known = by_times_.emplace(times_s, WeighPlaces(times_s, model_)).first;
    }
    return known->second;
  }

 private:
  TrackModel model_;
  std::map<std::vector<double>, DerivativeWeights> by_times_;
};

// The motion of the mean of a marker's corners. Motions of single corners are twice as noisy, and
// noise in the velocities makes the estimated readout time too short.
struct MarkerMotion {
  MotionVector motion;
  // Variances of the velocity: of errors that differ between markers, and of those due to what
  // happens between the frames, which the markers share.
  double noise_variance = 0.0;
  double common_variance = 0.0;
};

// Returns nothing unless the marker is seen in four frames (or three, if there are no more), and
// before and after this frame if there are such frames.
std::optional<MarkerMotion> MeasureMotion(const FrameWindow& window, const MarkerDetection& marker,
                                          PlaceWeights* weights) {
  const std::size_t min_num_frames = std::clamp<std::size_t>(window.size(), 3, 4);
  std::vector<double> times_s;
  Eigen::Matrix2Xd places_px(2, static_cast<Eigen::Index>(window.size()));
  for (const TimedFrame& frame : window) {
    const auto place = frame.places->find(marker.marker_id);
    const bool is_this_frame = frame.time_s == 0;  // or one that repeats it, with its own places
    if (!is_this_frame && place == frame.places->end()) continue;
    places_px.col(static_cast<Eigen::Index>(times_s.size())) =
        is_this_frame ? CornerMean(marker) : place->second;
    times_s.push_back(frame.time_s);
  }
  if (times_s.size() < min_num_frames) return std::nullopt;
  const auto is_between = [](double first_s, double last_s) { return first_s < 0 && last_s > 0; };
  if (is_between(window.front().time_s, window.back().time_s) &&
      !is_between(times_s.front(), times_s.back())) {
    return std::nullopt;
  }
  const DerivativeWeights& of_places = weights->At(times_s);
  const Eigen::Matrix<double, 2, 3> derivatives =
      places_px.leftCols(of_places.values.rows()) * of_places.values;
  return MarkerMotion{MotionVector(derivatives.reshaped()), of_places.noise_variance,
                      of_places.motion_variance};
}

// Markers share the errors due to what happens between the frames only as far as the same frames
// show them. What a marker that some frames lack has in addition is an error of its own.
void SplitCommonVariances(std::vector<std::optional<MarkerMotion>>* measured) {
  double shared = std::numeric_limits<double>::infinity();
  for (const auto& marker : *measured) {
    if (marker) shared = std::min(shared, marker->common_variance);
  }
  for (auto& marker : *measured) {
    if (!marker) continue;
    marker->noise_variance += marker->common_variance - shared;
    marker->common_variance = shared;
  }
}

struct FrameMotion {
  const DatabaseImage* image = nullptr;
  std::vector<std::optional<MarkerMotion>> measured;  // by marker
  std::optional<MotionField> field;

  // Of a velocity relative to the field, for markers whose own velocities have this variance.
  double Weight(std::size_t i, double own_variance) const {
    const double variance = measured[i]->noise_variance + own_variance;
    return variance > 0 ? 1.0 / variance : 1.0;
  }

  // No field for fewer than three markers.
  void FitField(double own_variance) {
    constexpr std::size_t kMinNumMarkers = 3;
    std::vector<PlacedMotion> motions;
    double sum_of_sides_px = 0.0;
    for (std::size_t i = 0; i < measured.size(); ++i) {
      if (!measured[i]) continue;
      const MarkerDetection& marker = image->detections.markers[i];
      motions.push_back({CornerMean(marker), measured[i]->motion, Weight(i, own_variance)});
      sum_of_sides_px += QuadMeanSide(marker.corners_in_image_px);
    }
    if (motions.size() < kMinNumMarkers) return;
    field.emplace(motions, sum_of_sides_px / static_cast<double>(motions.size()));
  }

  // The velocity of marker `i` relative to the field.
  Eigen::Vector2d OwnVelocity(std::size_t i) const {
    const Eigen::Vector2d place_px = CornerMean(image->detections.markers[i]);
    return (measured[i]->motion - field->At(place_px)).head<2>();
  }
};

// Variance of the coordinates of the markers' velocities relative to the field, beyond noise;
// infinite if no frame has more markers than are needed to determine the field. The fields were
// fitted with the weights for `assumed_variance`.
double OwnVariance(const std::vector<FrameMotion>& frames, double assumed_variance) {
  double sum_of_squares = 0.0, sum_of_noise = 0.0, sum_of_weights = 0.0;
  for (const FrameMotion& frame : frames) {
    if (!frame.field) continue;
    double num_markers = 0.0, squares = 0.0, noise = 0.0, weights = 0.0;
    for (std::size_t i = 0; i < frame.measured.size(); ++i) {
      if (!frame.measured[i]) continue;
      const double weight = frame.Weight(i, assumed_variance);
      num_markers += 1.0;
      squares += 0.5 * weight * frame.OwnVelocity(i).squaredNorm();
      noise += weight * frame.measured[i]->noise_variance;
      weights += weight;
    }
    const double free_share = 1.0 - (1 + MotionField::kNumTerms) / num_markers;
    if (!(free_share > 0)) continue;
    sum_of_squares += squares;
    sum_of_noise += free_share * noise;
    sum_of_weights += free_share * weights;
  }
  if (sum_of_weights == 0) return std::numeric_limits<double>::infinity();
  return std::max(0.0, (sum_of_squares - sum_of_noise) / sum_of_weights);
}

// Fits the fields of all frames and returns OwnVariance().
double FitFields(std::vector<FrameMotion>* frames) {
  constexpr int kNumRounds = 3;
  double own_variance = 0.0;
  for (int round = 0; round < kNumRounds && std::isfinite(own_variance); ++round) {
    for (FrameMotion& frame : *frames) frame.FitField(own_variance);
    own_variance = OwnVariance(*frames, own_variance);
  }
  return own_variance;
}

// Empty if the neighbouring frames show too few markers.
std::vector<CornerMotion> MotionsOf(const FrameMotion& frame, double own_variance) {
  std::vector<CornerMotion> motions;
  double common_variance = 0.0;  // the field's
  for (const auto& measured : frame.measured) {
    if (measured) common_variance = measured->common_variance;
  }
  for (std::size_t i = 0; i < frame.measured.size(); ++i) {
    const std::optional<MarkerMotion>& measured = frame.measured[i];
    if (!measured && !frame.field) return {};
    // The marker's velocity relative to the field, shrunk by its share of noise. Higher derivatives
    // are too noisy to depart from those of the field.
    MotionVector own = MotionVector::Zero();
    double unknown_variance = std::isfinite(own_variance) ? own_variance : 0.0;
    if (measured) {
      const double noise = measured->noise_variance;
      const double noise_share = noise > 0 ? noise / (own_variance + noise) : 0.0;
      if (frame.field) own.head<2>() = (1.0 - noise_share) * frame.OwnVelocity(i);
      unknown_variance = (1.0 - noise_share) * noise;
    }
    for (const Eigen::Vector2d& x_px : frame.image->detections.markers[i].corners_in_image_px) {
      // Within a marker, the velocity changes as in the field.
      const MotionVector motion = frame.field ? frame.field->At(x_px) + own : measured->motion;
      motions.push_back({motion.head<2>(), motion.segment<2>(2), motion.tail<2>(),
                         std::sqrt(common_variance + unknown_variance),
                         std::sqrt(common_variance)});
    }
  }
  return motions;
}

// The tracks of the markers that all frames of a window show. Returns nothing if the frame itself
// is the first or the last of the window.
std::optional<TrackWindow> TracksIn(const FrameWindow& window) {
  if (window.size() < kMinTimesOfWindow || !(window.front().time_s < 0) ||
      !(window.back().time_s > 0)) {
    return std::nullopt;
  }
  TrackWindow tracks;
  for (const TimedFrame& frame : window) {
    if (frame.time_s == 0) tracks.middle_idx = tracks.times_s.size();
    tracks.times_s.push_back(frame.time_s);
  }
  std::vector<double> places_px;  // row by row
  for (const MarkerDetection& marker : window[tracks.middle_idx].detections->markers) {
    Eigen::Matrix2Xd track_px(2, static_cast<Eigen::Index>(window.size()));
    Eigen::Index num_seen = 0;
    for (const TimedFrame& frame : window) {
      const MarkerDetection* seen = FindMarkerById(frame.detections->markers, marker.marker_id);
      if (seen == nullptr) break;
      track_px.col(num_seen++) = CornerMean(*seen);
    }
    if (num_seen < track_px.cols()) continue;
    for (const auto row : track_px.rowwise())
      places_px.insert(places_px.end(), row.begin(), row.end());
  }
  if (places_px.empty()) return std::nullopt;
  const auto num_times = static_cast<Eigen::Index>(window.size());
  tracks.places_px = Eigen::Map<const RowMajorTracks>(
      places_px.data(), static_cast<Eigen::Index>(places_px.size()) / num_times, num_times);
  return tracks;
}

// Uses windows spread over the video; smaller ones if no marker is seen throughout a larger one.
TrackModel FitTrackModel(const std::vector<Exposure>& exposures) {
  constexpr std::size_t kMaxNumWindows = 200;
  const std::size_t stride = 1 + exposures.size() / kMaxNumWindows;
  for (const std::size_t reach : {kReach, kReach / 2, kReach / 4}) {
    std::vector<TrackWindow> windows;
    for (std::size_t i = stride / 2; i < exposures.size(); i += stride) {
      if (auto tracks = TracksIn(WindowAround(exposures, i, reach))) {
        windows.push_back(std::move(*tracks));
      }
    }
    if (!windows.empty()) return FitTrackModel(windows);
  }
  return {};
}

}  // namespace

CornerMotions CornerMotionsOf(const std::vector<DatabaseImage>& images) {
  const std::vector<Exposure> exposures = ExposuresOf(images);
  const TrackModel model = FitTrackModel(exposures);
  std::vector<FrameMotion> frames;
  for (std::size_t i = 0; i < exposures.size(); ++i) {
    const FrameWindow window = WindowAround(exposures, i, kReach);
    PlaceWeights weights(model);
    for (const DatabaseImage* image : exposures[i].frames) {
      FrameMotion frame;
      frame.image = image;
      for (const MarkerDetection& marker : image->detections.markers) {
        frame.measured.push_back(MeasureMotion(window, marker, &weights));
      }
      SplitCommonVariances(&frame.measured);
      frames.push_back(std::move(frame));
    }
  }
  const double own_variance = FitFields(&frames);
  CornerMotions motions;
  for (const FrameMotion& frame : frames) {
    std::vector<CornerMotion> of_image = MotionsOf(frame, own_variance);
    if (!of_image.empty()) motions[frame.image->image_id] = std::move(of_image);
  }
  return motions;
}

}  // namespace velamap
