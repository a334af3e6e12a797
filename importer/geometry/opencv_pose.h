// Converts poses from OpenCV.

#pragma once

#include <opencv2/core.hpp>

#include "importer/geometry/pose_step.h"

namespace velamap {

// Both arguments are 3 x 1, CV_64F; the rotation vector is in rad.
inline Rigid3 RigidFromOpenCV(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  PoseStep step;
  for (int i = 0; i < 3; ++i) {
    step[i] = rotation_vector.at<double>(i);
    step[3 + i] = translation.at<double>(i);
  }
  return PlusPose({}, step);
}

}  // namespace velamap
