#include "reconstruct/registration/repeated_frames.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

// How far the markers move from one frame to the next, the RMS over those that both show, and the
// mean sigma of their corners.
struct FrameStep {
  double distance_px = 0.0, sigma_px = 0.0;
};

std::optional<FrameStep> FrameStepBetween(const FrameDetections& before,
                                          const FrameDetections& after) {
  std::vector<double> distances_px;
  double sum_px = 0.0;
  auto old = before.markers.begin();
  for (const MarkerDetection& marker : after.markers) {  // both are in the order of their ids
    while (old != before.markers.end() && old->marker_id < marker.marker_id) ++old;
    if (old == before.markers.end()) break;
    if (old->marker_id != marker.marker_id) continue;
    distances_px.push_back((CornerMean(marker) - CornerMean(*old)).norm());
    for (const double sigma_px : marker.corner_sigma_px) sum_px += sigma_px / kNumCorners;
  }
  if (distances_px.empty()) return std::nullopt;
  return FrameStep{Rms(distances_px), sum_px / static_cast<double>(distances_px.size())};
}

// The upper quartile of the six steps before and the six after: a cut does not count, and a video
// of which two frames in three are repeated still shows its motion.
std::optional<double> UsualFrameStep(const std::vector<std::optional<FrameStep>>& steps,
                                     std::size_t idx) {
  constexpr std::size_t kReach = 6;
  std::vector<double> around;
  const std::size_t end = std::min(idx + kReach + 1, steps.size());
  for (std::size_t i = idx < kReach ? 0 : idx - kReach; i < end; ++i) {
    if (i != idx && steps[i]) around.push_back(steps[i]->distance_px);
  }
  if (around.empty()) return std::nullopt;
  const auto quartile = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 4);
  std::nth_element(around.begin(), quartile, around.end(), std::greater<>());
  return *quartile;
}

}  // namespace

std::vector<bool> FindRepeatedFrames(const std::vector<const DatabaseImage*>& frames) {
  // Compression moves markers of a repeated frame by some hundredths of a pixel. With a larger
  // share, frames in which a shaking camera turns back would be taken for repeated ones.
  constexpr double kMaxShare = 0.03;
  // Two pictures of the same scene have independent noise, and their markers are one sigma apart.
  constexpr double kMaxSigmas = 0.2;
  std::vector<std::optional<FrameStep>> steps(frames.size());
  for (std::size_t i = 1; i < frames.size(); ++i) {
    steps[i] = FrameStepBetween(frames[i - 1]->detections, frames[i]->detections);
  }
  std::vector<bool> is_repeated(frames.size(), false);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (!steps[i]) continue;
    const double distance_px = steps[i]->distance_px;
    const std::optional<double> usual_px = UsualFrameStep(steps, i);
    is_repeated[i] = distance_px <= kMaxSigmas * steps[i]->sigma_px ||
                     (usual_px && distance_px < kMaxShare * *usual_px);
  }
  return is_repeated;
}

}  // namespace velamap
