// Which frames of a video take part in global registration: chosen for what they add.

#pragma once

#include <vector>

#include "reconstruct/global/map_problem.h"

namespace velamap {

// Before anything is registered: of every stretch of the video (max_num_frames of equal length) the
// frame with most markers, where a blurred marker counts less. Indices ascend.
std::vector<int> ChooseCandidateFrames(const std::vector<const DatabaseImage*>& images,
                                       int max_num_frames);

// Of registered frames those that make the markers' centres most precise: one after another the
// frame that adds most to the sum of the log-determinants of the centres' information matrices.
// That weighs parallax, coverage of the markers, distance and sharpness (`sigma_of_frame` in px, by
// frame_idx) at once. `first_idx` is in any case. Indices ascend.
std::vector<int> ChooseViews(const MapProblem& problem, const MapSolution& solution,
                             const std::vector<double>& sigma_of_frame, int first_idx,
                             int max_num_frames);

}  // namespace velamap
