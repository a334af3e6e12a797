// The focal length of an unknown camera, estimated from single markers.
//
// The image of a square determines its pose and, if the square is tilted, constrains the focal
// length, which determines how strongly the two receding sides converge (Zhang, "A flexible new
// technique for camera calibration", 2000, with one plane and square pixels). For each focal
// length, the better planar pose of every marker is used (IPPE, two solutions); the remaining
// errors of its corners depend on the focal length alone. The errors of all markers, each divided
// by its corners' sigma, are pooled with a Cauchy loss.

#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "importer/base/ids.h"
#include "importer/camera/camera.h"

namespace velamap {

// The corners of one square, 1..4, and their sigma, px.
struct SquareView {
  std::array<Eigen::Vector2d, kNumCorners> corners_px;
  double sigma_px = 0.0;
};

struct FocalEvidence {
  Camera camera;  // without distortion: SIMPLE_RADIAL or OPENCV_FISHEYE, principal point central
  // 1 sigma of the logarithm of the focal length, from the scatter of the views; large where the
  // squares face the camera or are too small to tell.
  double log_sigma = 0.0;
  double cost = 0.0;  // sum of the pooled losses; to be compared between lenses of the same views
  int num_views = 0;  // that took part
};

inline constexpr std::size_t kMaxFocalViews = 600;

// The best focal length of a lens of this `model` (kSimpleRadial, straight lines stay straight, or
// kOpenCVFisheye, equidistant), between 0.2 and 10 times the larger side of the picture. At most
// `kMaxFocalViews` views take part, the largest as a multiple of their sigma. `num_threads` 0: one
// per core; the result does not depend on it. Without views the result is UnknownCamera()'s focal
// length with an infinite sigma.
FocalEvidence FindFocalLength(CameraModel model, int width_px, int height_px,
                              std::vector<SquareView> views, int num_threads = 0);

}  // namespace velamap
