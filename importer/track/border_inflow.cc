#include "importer/track/border_inflow.h"

#include <algorithm>
#include <cstddef>

#include "importer/detect/marker_search.h"

namespace velamap {
namespace {

// The inflow at which the band along a border is searched, as a fraction of the width of the
// picture, and how much wider than the largest marker the band is.
constexpr double kMinInflowFraction = 0.004;
constexpr double kBandPerMarker = 1.3;

}  // namespace

BorderInflow AddInflow(const std::vector<PointMotion>& motions, const cv::Size& size,
                       BorderInflow inflow_px) {
  const double w = size.width, h = size.height;
  inflow_px[0] += LocalMotion(motions, {0.0, 0.5 * h}).x();
  inflow_px[1] += LocalMotion(motions, {0.5 * w, 0.0}).y();
  inflow_px[2] -= LocalMotion(motions, {w, 0.5 * h}).x();
  inflow_px[3] -= LocalMotion(motions, {0.5 * w, h}).y();
  // Outward motion is limited, because new markers may come in as soon as the picture returns from
  // a long one.
  for (double& inflow : inflow_px) inflow = std::max(inflow, -0.02 * size.width);
  return inflow_px;
}

std::vector<cv::Rect> BorderRegions(double marker_px, const cv::Size& size,
                                    BorderInflow* inflow_px) {
  std::vector<cv::Rect> regions;
  for (std::size_t side = 0; side < inflow_px->size(); ++side) {
    double& inflow = (*inflow_px)[side];
    if (inflow < kMinInflowFraction * size.width) continue;
    const int depth_px = static_cast<int>(kBandPerMarker * marker_px + inflow) + kSearchReachPx + 4;
    cv::Rect band(0, 0, size.width, size.height);
    (side % 2 == 0 ? band.width : band.height) = depth_px;
    if (side == 2) band.x = size.width - depth_px;
    if (side == 3) band.y = size.height - depth_px;
    regions.push_back(band & cv::Rect({0, 0}, size));
    inflow = 0.0;
  }
  return regions;
}

}  // namespace velamap
