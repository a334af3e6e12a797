// A picture as a sum of polygons, each weighted by the exact part of every pixel that it covers.
//
// Polygons that share an edge leave no seam and no double line there, because their shares of a
// pixel add up; so a surface may be cut into as many pieces as its curvature asks for. Image frame:
// pixel (column, row) covers [column, column + 1] x [row, row + 1], as in COLMAP.

#pragma once

#include <array>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace velamap {

// Corners in the image frame, px, clockwise as seen in the picture.
using ImageQuad = std::array<Eigen::Vector2d, 4>;

// Negative where the quad shows its back.
double SignedArea(const ImageQuad& quad);

class CoverageImage {
 public:
  CoverageImage(int width_px, int height_px);

  // Adds `gray` (grey levels) and `alpha` (share of what lies behind that is hidden), times the
  // covered part of each pixel. What reaches beyond the image is cut off.
  void Add(const ImageQuad& quad, double gray, double alpha);

  // The sums, CV_32FC2: grey levels, alpha. Call it once, at the end.
  cv::Mat Resolve();

 private:
  void AddEdge(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const cv::Vec2f& weight);

  cv::Mat changes_;  // from each pixel to its right neighbour; CV_32FC2
};

}  // namespace velamap
