#include "reconstruct/registration/track_gaps.h"

#include <cstddef>
#include <optional>

#include "reconstruct/registration/motion_field.h"

namespace velamap {
namespace {

// How the markers that both frames show move from one to the other, px. Returns nothing if these
// are fewer than three.
std::optional<MotionField> DisplacementField(const TimedPlaces& from, const TimedPlaces& to) {
  constexpr std::size_t kMinNumMarkers = 3;
  std::vector<PlacedMotion> motions;
  for (const auto& [marker_id, place_px] : from.places) {
    const auto next = to.places.find(marker_id);
    if (next == to.places.end()) continue;
    MotionVector motion = MotionVector::Zero();
    motion.head<2>() = next->second - place_px;
    motions.push_back({place_px, motion});
  }
  if (motions.size() < kMinNumMarkers) return std::nullopt;
  return MotionField(motions, from.side_px);
}

// Fills the gap of a marker between frames `first` and `last`, which show it. `fields` are those
// from each frame to the next.
void FillGap(int marker_id, std::size_t first, std::size_t last,
             const std::vector<std::optional<MotionField>>& fields,
             std::vector<TimedPlaces>* frames) {
  std::vector<Eigen::Vector2d> path_px = {(*frames)[first].places.at(marker_id)};
  for (std::size_t i = first; i < last; ++i) {
    if (!fields[i]) return;
    const Eigen::Vector2d place_px = path_px.back();
    path_px.push_back(place_px + fields[i]->At(place_px).head<2>());
  }
  const Eigen::Vector2d missed_px = (*frames)[last].places.at(marker_id) - path_px.back();
  const double begin_s = (*frames)[first].time_s, gap_s = (*frames)[last].time_s - begin_s;
  for (std::size_t i = first + 1; i < last; ++i) {
    TimedPlaces& frame = (*frames)[i];
    frame.places[marker_id] = path_px[i - first] + (frame.time_s - begin_s) / gap_s * missed_px;
  }
}

}  // namespace

TimedPlaces PlacesOf(const FrameDetections& frame) {
  TimedPlaces result;
  result.time_s = frame.time_s.value();
  for (const MarkerDetection& marker : frame.markers) {
    result.places.emplace(marker.marker_id, CornerMean(marker));
    result.side_px +=
        QuadMeanSide(marker.corners_in_image_px) / static_cast<double>(frame.markers.size());
  }
  return result;
}

void FillGaps(std::vector<TimedPlaces>* frames) {
  std::vector<std::optional<MotionField>> fields(frames->size());
  std::map<int, std::vector<std::size_t>> frames_by_id;
  for (std::size_t i = 0; i < frames->size(); ++i) {
    const TimedPlaces& frame = (*frames)[i];
    if (i + 1 < frames->size() && frame.is_near_next) {
      fields[i] = DisplacementField(frame, (*frames)[i + 1]);
    }
    for (const auto& [marker_id, place_px] : frame.places) frames_by_id[marker_id].push_back(i);
  }
  for (const auto& [marker_id, frame_idxs] : frames_by_id) {
    for (std::size_t k = 0; k + 1 < frame_idxs.size(); ++k) {
      FillGap(marker_id, frame_idxs[k], frame_idxs[k + 1], fields, frames);
    }
  }
}

}  // namespace velamap
