// Renders a picture as a sum of polygons, each weighted by the exact fraction of every pixel that
// it covers.
//
// Polygons that share an edge leave neither a gap nor a double line there, because their fractions
// of a pixel add up. A surface can therefore be divided as finely as its curvature requires. Image
// frame: pixel (column, row) covers [column, column + 1] x [row, row + 1], as in COLMAP.

#pragma once

#include <array>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace velamap {

// Corners in the image frame, px, clockwise as seen in the picture.
using ImageQuad = std::array<Eigen::Vector2d, 4>;

// The area, px^2; negative if the quad shows its back.
double SignedArea(const ImageQuad& quad);

class CoverageImage {
 public:
  CoverageImage(int width_px, int height_px);

  // Adds `gray` (grey levels) and `alpha` (opacity), times the covered fraction of each pixel. The
  // quad is clipped to the image.
  void Add(const ImageQuad& quad, double gray, double alpha);

  // The sums of grey levels and alpha, CV_32FC2. To be called once, at the end.
  cv::Mat Resolve();

 private:
  void AddEdge(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const cv::Vec2f& weight);

  cv::Mat changes_;  // of the sums from one pixel to the next in a row; CV_32FC2
};

}  // namespace velamap
