#include "reconstruct/global/view_selection.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "importer/geometry/pose_step.h"

namespace velamap {
namespace {

// Corners with this sigma (px) or a smaller one give a marker the full weight of 1.
constexpr double kSharpSigmaPx = 0.1;
constexpr double kFallbackWeight = 0.5;

double SumOfMarkerWeights(const DatabaseImage& image) {
  double sum = 0.0;
  for (const MarkerDetection& marker : image.detections.markers) {
    double sigma_px = 0.0;
    for (const double corner_sigma_px : marker.corner_sigma_px) {
      sigma_px = std::max(sigma_px, corner_sigma_px);
    }
    sum += (marker.is_fallback ? kFallbackWeight : 1.0) *
           std::min(1.0, kSharpSigmaPx / std::max(sigma_px, 1e-9));
  }
  return sum;
}

// One view of the centre of a marker and its information matrix, 1/m^2.
struct CenterView {
  std::size_t marker_idx;
  Eigen::Matrix3d information;
};

std::vector<CenterView> ViewsOf(const MapProblem& problem, const MapSolution& solution,
                                int frame_idx, double sigma_factor) {
  std::vector<CenterView> views;
  const Rigid3& pose = *solution.Pose(frame_idx);
  const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
  for (const int idx : problem.Frame(frame_idx).observation_idxs) {
    if (!solution.IsInlier(idx)) continue;
    const MapObservation& observation = problem.Observation(idx);
    const std::size_t marker_idx = static_cast<std::size_t>(observation.marker_idx);
    const Eigen::Vector3d x = pose * solution.shape_from_marker[marker_idx].front().translation;
    const Eigen::Matrix<double, 2, 3> jacobian = observation.px_from_ray[0] * RayByPoint(x) *
                                                 rotation / (sigma_factor * observation.sigma_px);
    views.push_back({marker_idx, jacobian.transpose() * jacobian});
  }
  return views;
}

double LogDeterminant(const Eigen::Matrix3d& information) {
  return std::log(std::max(information.determinant(), 1e-300));
}

}  // namespace

std::vector<int> ChooseCandidateFrames(const std::vector<const DatabaseImage*>& images,
                                       std::size_t max_num_frames) {
  std::vector<int> chosen;
  const std::size_t num_stretches = std::min(images.size(), max_num_frames);
  for (std::size_t stretch = 0; stretch < num_stretches; ++stretch) {
    const std::size_t begin = stretch * images.size() / num_stretches;
    const std::size_t end = (stretch + 1) * images.size() / num_stretches;
    const auto best = std::max_element(images.begin() + static_cast<std::ptrdiff_t>(begin),
                                       images.begin() + static_cast<std::ptrdiff_t>(end),
                                       [](const DatabaseImage* a, const DatabaseImage* b) {
                                         return SumOfMarkerWeights(*a) < SumOfMarkerWeights(*b);
                                       });
    chosen.push_back(static_cast<int>(best - images.begin()));
  }
  return chosen;
}

std::vector<int> ChooseViews(const MapProblem& problem, const MapSolution& solution,
                             const std::vector<double>& sigma_factor_of_frame, int first_idx,
                             int max_num_frames) {
  std::vector<int> registered;
  for (std::size_t idx = 0; idx < problem.frames.size(); ++idx) {
    if (solution.cam_from_shape[idx]) registered.push_back(static_cast<int>(idx));
  }
  if (static_cast<int>(registered.size()) <= max_num_frames) return registered;
  std::vector<std::vector<CenterView>> views(problem.frames.size());
  // A small fraction of the information of all views, so that determinants are not zero at the
  // start.
  constexpr double kPrior = 1e-3;
  std::vector<Eigen::Matrix3d> information(problem.markers.size(), Eigen::Matrix3d::Zero());
  for (const int idx : registered) {
    views[static_cast<std::size_t>(idx)] =
        ViewsOf(problem, solution, idx, sigma_factor_of_frame[static_cast<std::size_t>(idx)]);
    for (const CenterView& view : views[static_cast<std::size_t>(idx)]) {
      information[view.marker_idx] += kPrior * view.information;
    }
  }
  const auto gain = [&](int idx) {
    double sum = 0.0;
    for (const CenterView& view : views[static_cast<std::size_t>(idx)]) {
      sum += LogDeterminant(information[view.marker_idx] + view.information) -
             LogDeterminant(information[view.marker_idx]);
    }
    return sum;
  };
  std::vector<int> chosen;
  int next_idx = first_idx;
  while (static_cast<int>(chosen.size()) < max_num_frames) {
    for (const CenterView& view : views[static_cast<std::size_t>(next_idx)]) {
      information[view.marker_idx] += view.information;
    }
    chosen.push_back(next_idx);
    registered.erase(std::find(registered.begin(), registered.end(), next_idx));
    double largest_gain = -1.0;
    for (const int idx : registered) {
      const double candidate_gain = gain(idx);
      if (candidate_gain <= largest_gain) continue;
      largest_gain = candidate_gain;
      next_idx = idx;
    }
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace velamap
