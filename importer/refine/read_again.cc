#include "importer/refine/read_again.h"

#include <algorithm>
#include <cstdint>

#include "importer/refine/corner_refinement.h"

namespace velamap {

ReadMarker RefineAndReadAgain(const cv::Mat& gray, const MarkerQuad& quad,
                              const Dictionary& dictionary, int border_bits,
                              const ImageFormation& formation) {
  constexpr double kClearlyBetter = 0.7;
  cv::Mat cells = MarkerCells(dictionary, quad.marker_id, border_bits);
  ReadMarker first{quad, RefineCorners(gray, quad.corners_px, cells, formation)};
  if (!first.refined || first.refined->mismatched_cells.empty()) return first;
  for (const cv::Point& cell : first.refined->mismatched_cells) {
    std::uint8_t& value = cells.at<std::uint8_t>(cell);
    value = value == 0 ? 255 : 0;
  }
  const auto code = ReadCells(dictionary, cells, border_bits);
  if (!code) return first;
  ReadMarker second{quad, {}};
  second.quad.marker_id = code->marker_id;
  QuadCorners& corners_px = second.quad.corners_px;
  std::rotate(corners_px.begin(), corners_px.begin() + code->first_corner, corners_px.end());
  second.refined = RefineCorners(gray, corners_px,
                                 MarkerCells(dictionary, code->marker_id, border_bits), formation);
  const bool is_better = second.refined && second.refined->rms_gray > 0 &&
                         second.refined->rms_gray < kClearlyBetter * first.refined->rms_gray;
  return is_better ? second : first;
}

}  // namespace velamap
