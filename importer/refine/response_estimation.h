// What camera and print do to edges, from the markers of a clip: the response (camera_response.h)
// and the spread of the ink that explain the pixels of all sampled markers best.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "importer/refine/pattern_fit.h"

namespace velamap {

struct ResponseSample {
  cv::Mat gray;  // 8 bit, the marker with its surroundings
  QuadCorners corners_px;
  cv::Mat cells;
};

struct ResponseEstimate {
  CameraResponse response;
  double spread_sides = 0.0;
  Eigen::Matrix<double, 5, 1> sigma = Eigen::Matrix<double, 5, 1>::Zero();
  double rms = 0.0;
  int num_iterations = 0;
  int num_samples = 0;
};

ResponseEstimate EstimateResponse(const std::vector<ResponseSample>& samples, bool is_inverted);

ResponseModel MakeResponseModel(const CameraResponse& response, double spread_sides);

}  // namespace velamap
