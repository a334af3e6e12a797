// Derivatives with respect to time of the paths of points whose places are known at several times,
// with errors.

#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace velamap {

// Motions for which the septic smoothing spline is the best estimate: the fourth derivative of a
// coordinate is white noise, and each place has an independent error (Wahba, "Improper priors,
// spline smoothing and the problem of guarding against model errors in regression", 1978).
struct TrackModel {
  double unit_s = 1.0;  // unit of time of the following
  // Variance of the errors of places over that of the motion; the latter in px^2.
  double noise_ratio = 0.0;
  double motion_variance = 0.0;
};

// The derivatives at time 0 are sums of the places weighted by the columns.
struct DerivativeWeights {
  // For the velocity, 1/s, the acceleration, 1/s^2, and the jerk, 1/s^3.
  Eigen::MatrixX3d values;
  // Variance of the velocity due to the errors of the places, and that due to what the point may
  // have done between and after them; (px/s)^2.
  double noise_variance = 0.0;
  double motion_variance = 0.0;
};

// `times_s` holds at least three times. The weights for three or four places are those of the
// polynomial through them. For three, the variances are zero, because it takes a fourth place to
// estimate them.
DerivativeWeights WeighPlaces(const std::vector<double>& times_s, const TrackModel& model);

// Tracks of several points that are seen at the same times, at least kMinTimesOfWindow.
struct TrackWindow {
  std::vector<double> times_s;
  std::size_t middle_idx = 0;
  Eigen::MatrixXd places_px;  // by column; two rows for each point
};
inline constexpr std::size_t kMinTimesOfWindow = 5;

// The model under which the middle places of the windows are the most likely ones, given the others
// of their windows (leave-one-out predictive likelihood). The errors in a window count by their
// median, because single points may have been mistaken for others. `windows` must not be empty.
TrackModel FitTrackModel(const std::vector<TrackWindow>& windows);

}  // namespace velamap
