// What a camera and a print do to edges, estimated from markers: the image formation that explains
// the pixels of all samples best. Each sample keeps parameters of its own (corners, blur, levels,
// margins); the image formation is common to all.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "importer/refine/image_formation.h"

namespace velamap {

struct FormationSample {
  cv::Mat gray;            // 8 bit: the marker with half a side around it, dark cells dark
  QuadCorners corners_px;  // OpenCV's pixel frame of `gray`, to a pixel
  cv::Mat cells;           // as in FitPattern()
};

struct FormationEstimate {
  ImageFormationParameters parameters;
  int num_samples = 0;      // that could be fitted; 0: nothing is known
  double noise_gray = 0.0;  // robust standard deviation of the residuals, grey levels
};

// Levenberg-Marquardt over gamma, S, sharpening, its radius and the ink's spread, with a Cauchy
// loss and weak priors around a usual camera; the samples are fitted again after each step. Starts
// from several gammas. `is_inverted`: the samples hold 255 less the recorded grey values. The
// number of threads (0: one a core) does not change the result.
FormationEstimate EstimateFormation(const std::vector<FormationSample>& samples, bool is_inverted,
                                    int num_threads = 1);

}  // namespace velamap
