// Selection of the frames of a video for global registration, by their gain in precision.

#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/map/map_problem.h"

namespace velamap {

// Selection before the registration: divides the images into `max_num_frames` stretches of equal
// length and takes from each the frame with most markers, where blurred markers count less. Indices
// ascend.
std::vector<int> ChooseCandidateFrames(const std::vector<const DatabaseImage*>& images,
                                       std::size_t max_num_frames);

// Selection of registered frames: greedily takes the frame that adds most to the sum of the
// log-determinants of the information matrices of all marker centres, which accounts for parallax,
// coverage of the markers, distance and sharpness together. `sigma_factor_of_frame`, by frame_idx,
// is the ratio of the scatter of a frame's corners to their sigmas. `first_idx` is always taken.
// Indices ascend.
std::vector<int> ChooseViews(const MapProblem& problem, const MapSolution& solution,
                             const std::vector<double>& sigma_factor_of_frame, int first_idx,
                             int max_num_frames);

}  // namespace velamap
