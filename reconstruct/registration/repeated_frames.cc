#include "reconstruct/registration/repeated_frames.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

// How far the markers move from one frame to the next: the RMS over those that both show, px.
std::optional<double> StepBetween(const FrameDetections& before, const FrameDetections& after) {
  std::vector<double> distances_px;
  auto old = before.markers.begin();
  for (const MarkerDetection& marker : after.markers) {  // both are in the order of their ids
    while (old != before.markers.end() && old->marker_id < marker.marker_id) ++old;
    if (old == before.markers.end()) break;
    if (old->marker_id != marker.marker_id) continue;
    distances_px.push_back((CornerMean(marker) - CornerMean(*old)).norm());
  }
  if (distances_px.empty()) return std::nullopt;
  return Rms(distances_px);
}

// The upper quartile of the six steps before and the six after: a cut does not count, and a video
// of which two frames in three are repeated still shows its motion.
std::optional<double> UsualStep(const std::vector<std::optional<double>>& steps_px,
                                std::size_t idx) {
  constexpr std::size_t kReach = 6;
  std::vector<double> around;
  const std::size_t end = std::min(idx + kReach + 1, steps_px.size());
  for (std::size_t i = idx < kReach ? 0 : idx - kReach; i < end; ++i) {
    if (i != idx && steps_px[i]) around.push_back(*steps_px[i]);
  }
  if (around.empty()) return std::nullopt;
  const auto quartile = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 4);
  std::nth_element(around.begin(), quartile, around.end(), std::greater<>());
  return *quartile;
}

}  // namespace

std::vector<bool> FindRepeatedFrames(const std::vector<const DatabaseImage*>& frames) {
  // Compression moves markers of a repeated frame by some hundredths of a pixel. A larger share
  // would take frames in which a shaking camera turns back for repeated ones.
  constexpr double kMaxShare = 0.03;
  std::vector<std::optional<double>> steps_px(frames.size());
  for (std::size_t i = 1; i < frames.size(); ++i) {
    steps_px[i] = StepBetween(frames[i - 1]->detections, frames[i]->detections);
  }
  std::vector<bool> is_repeated(frames.size(), false);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const std::optional<double> usual_px = UsualStep(steps_px, i);
    is_repeated[i] = steps_px[i] && usual_px && *steps_px[i] < kMaxShare * *usual_px;
  }
  return is_repeated;
}

}  // namespace velamap
