#include "importer/refine/read_again.h"

#include <algorithm>
#include <cstdint>

#include "importer/bend/pattern_bend.h"
#include "importer/refine/corner_refinement.h"

namespace velamap {

KnownMarker KnownMarkerAt(const MarkerQuad& quad, const Dictionary& dictionary, int border_bits,
                          const std::vector<double>& sides_mm, const Camera* camera) {
  KnownMarker marker{MarkerCells(dictionary, quad.marker_id, border_bits)};
  const auto idx = static_cast<std::size_t>(quad.marker_id);
  if (idx < sides_mm.size() && sides_mm[idx] > 0) marker.side_mm = sides_mm[idx];
  if (camera != nullptr) marker.lens_bend = BendByLens(*camera, quad.corners_px);
  return marker;
}

ReadMarker RefineAndReadAgain(const cv::Mat& gray, const MarkerQuad& quad,
                              const Dictionary& dictionary, int border_bits,
                              const ImageFormation& formation, const std::vector<double>& sides_mm,
                              const Camera* camera) {
  constexpr double kClearlyBetter = 0.7;
  KnownMarker marker = KnownMarkerAt(quad, dictionary, border_bits, sides_mm, camera);
  ReadMarker first{quad, RefineCorners(gray, quad.corners_px, marker, formation)};
  if (!first.refined || first.refined->mismatched_cells.empty()) return first;
  for (const cv::Point& cell : first.refined->mismatched_cells) {
    std::uint8_t& value = marker.cells.at<std::uint8_t>(cell);
    value = value == 0 ? 255 : 0;
  }
  const auto code = ReadCells(dictionary, marker.cells, border_bits);
  if (!code) return first;
  ReadMarker second{quad, {}};
  second.quad.marker_id = code->marker_id;
  QuadCorners& corners_px = second.quad.corners_px;
  std::rotate(corners_px.begin(), corners_px.begin() + code->first_corner, corners_px.end());
  marker = KnownMarkerAt(second.quad, dictionary, border_bits, sides_mm, camera);
  second.refined = RefineCorners(gray, corners_px, marker, formation);
  const bool is_better = second.refined && second.refined->rms_gray > 0 &&
                         second.refined->rms_gray < kClearlyBetter * first.refined->rms_gray;
  return is_better ? second : first;
}

}  // namespace velamap
