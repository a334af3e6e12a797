// The state of a global registration.

#pragma once

#include <map>
#include <string>
#include <vector>

#include "reconstruct/map/map_growth.h"
#include "reconstruct/map/map_problem.h"
#include "reconstruct/map/map_verdict.h"
#include "reconstruct/registration/registration.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

// The input, and the decisions with their reasons.
struct GlobalRegistration {
  const RegistrationOptions& options;
  std::vector<const DatabaseImage*> images;  // all with markers
  std::vector<int> image_idx_of_frame;       // by frame_idx of the problem
  bool is_video = false;
  int central_image_idx = -1;  // named by option; -1: none
  MapProblem problem;
  MapSolution solution;
  MapNoise noise;
  std::vector<LeftOut> left_out_of_image;        // by index in `images`
  std::map<int, DroppedMarker> dropped_markers;  // by marker_idx
  std::vector<std::string> notes;
  // Number of map markers in each frame that contradicts the map, by frame_idx.
  std::map<int, int> num_contradicting_of_frame{};

  MapGrowthOptions Growth() const {
    return {options.min_num_inliers, 0, true, static_cast<std::uint32_t>(options.random_seed),
            options.num_threads};
  }
  int NumInliers(int marker_idx) const;  // observations of the marker
  int NumInliersInFrame(int frame_idx) const;
  double MedianMarkerScale() const;  // over the markers with two inliers or more
  // Remove a frame or a marker from the solution.
  void LeaveOut(int frame_idx, LeftOut left_out);
  void Drop(int marker_idx, const std::string& reason);
};

}  // namespace velamap
