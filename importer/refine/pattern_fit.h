// Corners of a small marker from all of its pixels, by least squares on a picture of the marker.
//
// When cells are only one to four px wide, the blur of each edge reaches the next one and a side
// cannot be fitted on its own. The marker's cells are known, so the whole picture is:
//
//   I(x) = (1 + gradient . x) * (dark + (light - dark) * sum_ij cell_ij a_i(u) b_j(v))
//   x = H(u, v) + 4 u (1 - u) bend_u + 4 v (1 - v) bend_v
//
// H is the homography given by the four corners; the bends (px) are what cloth or a lens adds; a_i
// and b_j are the unit steps of column i and row j blurred by a Gaussian (px, one width along u and
// one along v, which also covers shaken pictures). Around the black square lie one cell of quiet
// zone and then whatever the image shows there. The marker's own light cells have a level apart
// from the quiet zone's: with one level for both, markers of 50 px in real photographs, and the
// same scaled down to 17 px, came out another 0.4 % too small.

#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "importer/refine/camera_response.h"
#include "importer/refine/refined_corners.h"

namespace velamap {

struct ResponseModel {
  ToneCurve tone{CameraResponse{}};
  cv::Mat unsharpening;
  double spread_sides = 0.0;  // how far the ink of dark cells reaches beyond their outlines
};

// `cells`: 8-bit, square, with the black border, zero for black; row 0 runs from corner 0 to 1 and
// column 0 from corner 0 to 3. Corners in OpenCV's pixel frame. Nothing if the marker leaves the
// image, has too little contrast or does not look like its cells.
std::optional<RefinedCorners> FitPattern(const cv::Mat& gray, const QuadCorners& corners_px,
                                         const cv::Mat& cells, const ResponseModel& response);

// A marker whose fit can be repeated with other responses of the camera.
class PatternSample {
 public:
  static std::optional<PatternSample> Make(const cv::Mat& gray, const QuadCorners& corners_px,
                                           const cv::Mat& cells, const ResponseModel& response);
  ~PatternSample();
  PatternSample(PatternSample&&) noexcept;
  PatternSample& operator=(PatternSample&&) noexcept;
  PatternSample Clone() const;
  int NumPixels() const;
  bool Refit(const ResponseModel& response);
  std::vector<float> Residuals(const CameraResponse& camera) const;

 private:
  class Impl;
  explicit PatternSample(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace velamap
