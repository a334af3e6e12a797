#include "reconstruct/thesis/shape_averaging.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "importer/base/error.h"

namespace velamap {
namespace {

// The medoid is chosen among the solutions of at most this many frames, spread over the list, so
// that the time is linear in the number of frames.
constexpr std::size_t kMaxMedoidFrames = 16;

const MarkerPoints& Nearest(const MarkerSolutions& solutions, const MarkerPoints& target) {
  return *std::min_element(solutions.begin(), solutions.end(),
                           [&target](const MarkerPoints& a, const MarkerPoints& b) {
                             return RmsDistance(a, target) < RmsDistance(b, target);
                           });
}

MarkerPoints FindMedoid(const std::vector<MarkerSolutions>& frames) {
  MarkerPoints best = frames.front().front();
  double best_cost = std::numeric_limits<double>::max();
  const std::size_t step = (frames.size() + kMaxMedoidFrames - 1) / kMaxMedoidFrames;
  for (std::size_t i = 0; i < frames.size(); i += step) {
    for (const MarkerPoints& candidate : frames[i]) {
      double cost = 0.0;
      for (const MarkerSolutions& other : frames) {
        cost += RmsDistance(Nearest(other, candidate), candidate);
      }
      if (cost < best_cost) {
        best_cost = cost;
        best = candidate;
      }
    }
  }
  return best;
}

}  // namespace

MarkerPoints AverageMarker(const std::vector<MarkerSolutions>& frames,
                           const ThesisRegistrationOptions& options) {
  VELAMAP_CHECK(!frames.empty() && options.mean_sigma_m > 0);
  const MarkerPoints medoid = FindMedoid(frames);
  std::vector<const MarkerPoints*> chosen;
  for (const MarkerSolutions& solutions : frames) chosen.push_back(&Nearest(solutions, medoid));

  MarkerPoints mean;
  for (std::size_t point = 0; point < mean.size(); ++point) {
    mean[point].setZero();
    for (const MarkerPoints* points : chosen) {
      mean[point] += (*points)[point] / static_cast<double>(chosen.size());
    }
    for (int iteration = 0; iteration < options.num_mean_iterations; ++iteration) {
      Eigen::Vector3d weighted_sum = Eigen::Vector3d::Zero();
      double sum_of_weights = 0.0;
      for (const MarkerPoints* points : chosen) {
        const double weight =
            std::exp(-((*points)[point] - mean[point]).norm() / options.mean_sigma_m);
        weighted_sum += weight * (*points)[point];
        sum_of_weights += weight;
      }
      if (!(sum_of_weights > 0)) break;  // all weights underflow: keep the last mean
      mean[point] = weighted_sum / sum_of_weights;
    }
  }
  return mean;
}

}  // namespace velamap
