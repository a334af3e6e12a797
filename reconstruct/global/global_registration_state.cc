#include "reconstruct/global/global_registration_state.h"

#include <utility>

#include "importer/base/statistics.h"

namespace velamap {

int GlobalRegistration::NumInliers(int marker_idx) const {
  return velamap::NumInliers(problem, solution, marker_idx);
}

int GlobalRegistration::NumInliersInFrame(int frame_idx) const {
  int count = 0;
  for (const int idx : problem.Frame(frame_idx).observation_idxs) {
    count += solution.IsInlier(idx);
  }
  return count;
}

double GlobalRegistration::MedianMarkerScale() const {
  std::vector<double> scales;
  for (std::size_t idx = 0; idx < problem.markers.size(); ++idx) {
    if (NumInliers(static_cast<int>(idx)) >= 2) {
      scales.push_back(solution.shape_from_marker[idx].front().scale);
    }
  }
  return scales.empty() ? 1.0 : Median(std::move(scales));
}

void GlobalRegistration::LeaveOut(int frame_idx, LeftOut left_out) {
  solution.cam_from_shape[static_cast<std::size_t>(frame_idx)].reset();
  for (const int idx : problem.Frame(frame_idx).observation_idxs) {
    solution.is_inlier[static_cast<std::size_t>(idx)] = 0;
  }
  left_out_of_image[static_cast<std::size_t>(
      image_idx_of_frame[static_cast<std::size_t>(frame_idx)])] = std::move(left_out);
}

void GlobalRegistration::Drop(int marker_idx, const std::string& reason) {
  dropped_markers[marker_idx] = {problem.Marker(marker_idx).marker_id, NumInliers(marker_idx),
                                 reason};
  solution.shape_from_marker[static_cast<std::size_t>(marker_idx)].clear();
  for (const int idx : problem.Marker(marker_idx).observation_idxs) {
    solution.is_inlier[static_cast<std::size_t>(idx)] = 0;
  }
}

}  // namespace velamap
