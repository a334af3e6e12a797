// Blur hides the code of small cells, but not the outline of the marker. Outlines without a code
// are therefore searched again in an enlarged and sharpened picture of their surroundings.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace velamap {

using Outline = std::vector<cv::Point2f>;  // four corners in OpenCV's pixel frame

// Returns the outlines of `rejected` to search again: those with cells of at most 4 px, a limit
// that suffices for a blur of 1.5 px. Of outlines that lie over each other it returns only the
// largest, and none that lies over one of `read`. `num_cells` is the number of cells along a side
// of a marker, including its border.
std::vector<Outline> UnreadOutlines(const std::vector<Outline>& read, std::vector<Outline> rejected,
                                    int num_cells);

// The picture at kEnlargement times its size, sharpened.
constexpr int kEnlargement = 3;
cv::Mat EnlargedAndSharpened(const cv::Mat& gray);

// A place in the enlarged picture, in the frame of the picture itself.
cv::Point2f InOriginal(const cv::Point2f& enlarged_px);

}  // namespace velamap
