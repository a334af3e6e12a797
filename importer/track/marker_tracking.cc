#include "importer/track/marker_tracking.h"

#include <algorithm>
#include <utility>

#include "importer/detect/marker_search.h"
#include "importer/detect/search_regions.h"
#include "importer/track/local_motion.h"
#include "importer/track/marker_track.h"

namespace velamap {
namespace {

// If the regions fill a larger fraction of the picture than this, the whole frame is searched
// instead.
constexpr double kMaxSearchedFraction = 0.6;

// Finding fewer than this fraction of the expected markers means a jerk or a cut. Small markers are
// found in some frames only, so each counts by its hit rate.
constexpr double kMinFoundFraction = 0.5;

// Adds the marker if it is located at its place; false if not.
bool AddLocated(const FrameSearch& search, int marker_id, const QuadCorners& expected,
                double reach_px, std::vector<MarkerQuad>* quads) {
  const auto located = search.locate(marker_id, expected, reach_px);
  if (located) quads->push_back({marker_id, *located});
  return located.has_value();
}

// Locates a marker where it should be; if it is not seen clearly there, adds the region to search.
void LocateOrAddRegion(const FrameSearch& search, int marker_id, const TrackPrediction& prediction,
                       std::vector<MarkerQuad>* quads, std::vector<cv::Rect>* regions) {
  const Box box = BoundingBox(prediction.corners_px);
  if (!FitsIn(box, search.image_size, prediction.margin_px)) return;
  if (!AddLocated(search, marker_id, prediction.corners_px, prediction.margin_px, quads)) {
    regions->push_back(PixelsAround(box, search.image_size, prediction.margin_px + kSearchReachPx));
  }
}

// Adds the markers found in the regions. Returns false if these fill most of the picture.
bool SearchRegions(const FrameSearch& search, std::vector<cv::Rect> regions,
                   std::vector<MarkerQuad>* quads) {
  regions = MergeRegions(std::move(regions));
  if (TotalAreaPx(regions) > kMaxSearchedFraction * search.image_size.area()) return false;
  if (!regions.empty()) {
    const std::vector<MarkerQuad> found = search.search_regions(regions);
    quads->insert(quads->end(), found.begin(), found.end());
  }
  *quads = RemoveNested(std::move(*quads));
  return true;
}

// Locates the missing markers where they should be. Returns the regions where they are not seen
// clearly.
std::vector<cv::Rect> LocateExpected(const FrameSearch& search, std::vector<MarkerQuad>* quads) {
  std::vector<cv::Rect> unclear;
  if (!search.expect) return unclear;
  for (const auto& [quad, reach_px] : search.expect(*quads)) {
    LocateOrAddRegion(search, quad.marker_id, {quad.corners_px, reach_px}, quads, &unclear);
  }
  return unclear;
}

// The markers that pass 1 found, and how they have moved.
struct FirstPass {
  std::vector<MarkerQuad> quads;
  std::vector<int> quad_of_track;
  std::vector<PointMotion> motions;
};

// Returns nothing if the regions fill most of the picture.
std::optional<FirstPass> SearchByVelocity(const FrameSearch& search, int num_frames,
                                          const std::vector<MarkerTrack>& tracks) {
  std::vector<PointMotion> velocities;
  for (const MarkerTrack& track : tracks) {
    const Eigen::Vector2d center = QuadCenter(track.corners_px);
    if (track.velocity_px) velocities.push_back({center, center + *track.velocity_px});
  }
  FirstPass pass;
  std::vector<cv::Rect> regions;
  for (const MarkerTrack& track : tracks) {
    if (track.num_lost > 0) continue;
    LocateOrAddRegion(search, track.marker_id, PredictByVelocity(track, velocities, num_frames),
                      &pass.quads, &regions);
  }
  if (!SearchRegions(search, std::move(regions), &pass.quads)) return std::nullopt;
  pass.quad_of_track = Associate(tracks, pass.quads, search.image_size);
  pass.motions = MotionsOf(tracks, pass.quads, pass.quad_of_track);
  return pass;
}

// Whether far fewer markers are found than their hit rates predict.
bool HasLostTrack(const std::vector<MarkerTrack>& tracks, const std::vector<int>& quad_of_track,
                  const std::vector<PointMotion>& motions, const cv::Size& size) {
  double num_expected = 0.0, num_found = 0.0;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    const bool is_found = quad_of_track[t] >= 0;
    if (!is_found) {
      const TrackPrediction prediction = PredictByOthers(tracks[t], motions);
      if (!FitsIn(BoundingBox(prediction.corners_px), size, -prediction.margin_px)) continue;
    }
    num_expected += tracks[t].hit_rate;
    num_found += is_found;
  }
  return num_found < kMinFoundFraction * num_expected;
}

// Both passes; nothing if the whole frame has to be searched.
std::optional<std::vector<MarkerQuad>> SearchPlaces(const FrameSearch& search, int num_frames,
                                                    MarkerTracks* tracks) {
  const cv::Size& size = search.image_size;
  const std::optional<FirstPass> first = SearchByVelocity(search, num_frames, tracks->tracks);
  if (!first || first->motions.empty()) return std::nullopt;
  BorderInflow inflow_px = AddInflow(first->motions, size, tracks->inflow_px);
  std::vector<cv::Rect> regions = BorderRegions(LargestMarker(tracks->tracks), size, &inflow_px);
  std::vector<MarkerQuad> quads = first->quads;
  quads.insert(quads.end(), search.seen_coarsely.begin(), search.seen_coarsely.end());
  for (std::size_t t = 0; t < tracks->tracks.size(); ++t) {
    if (first->quad_of_track[t] >= 0) continue;
    const MarkerTrack& track = tracks->tracks[t];
    LocateOrAddRegion(search, track.marker_id, PredictByOthers(track, first->motions), &quads,
                      &regions);
  }
  if (!SearchRegions(search, std::move(regions), &quads)) return std::nullopt;
  const std::vector<int> quad_of_track = Associate(tracks->tracks, quads, size);
  if (HasLostTrack(tracks->tracks, quad_of_track, first->motions, size)) return std::nullopt;
  if (!SearchRegions(search, LocateExpected(search, &quads), &quads)) return std::nullopt;
  tracks->inflow_px = inflow_px;
  return quads;
}

void Advance(const std::vector<MarkerQuad>& quads, const cv::Size& size, int frame_number,
             MarkerTracks* tracks) {
  tracks->tracks =
      UpdateTracks(tracks->tracks, quads, size, std::max(1, frame_number - tracks->frame_number));
  tracks->frame_number = frame_number;
}

}  // namespace

std::vector<MarkerQuad> SearchTracked(const FrameSearch& search, int frame_number,
                                      MarkerTracks* tracks) {
  const int num_frames = std::max(1, frame_number - tracks->frame_number);
  std::optional<std::vector<MarkerQuad>> quads;
  if (!tracks->has_new) quads = SearchPlaces(search, num_frames, tracks);
  if (quads) {
    Advance(*quads, search.image_size, frame_number, tracks);
    return *std::move(quads);
  }
  return CompleteFullSearch(search, search.search_regions({cv::Rect({0, 0}, search.image_size)}),
                            frame_number, tracks);
}

std::vector<MarkerQuad> CompleteFullSearch(const FrameSearch& search, std::vector<MarkerQuad> quads,
                                           int frame_number, MarkerTracks* tracks) {
  const std::vector<int> quad_of_track = Associate(tracks->tracks, quads, search.image_size);
  const std::vector<PointMotion> motions = MotionsOf(tracks->tracks, quads, quad_of_track);
  const auto num_known = std::count_if(quad_of_track.begin(), quad_of_track.end(),
                                       [](int quad_idx) { return quad_idx >= 0; });
  const auto num_new = static_cast<std::ptrdiff_t>(quads.size()) - num_known;
  for (std::size_t t = 0; !motions.empty() && t < tracks->tracks.size(); ++t) {
    if (quad_of_track[t] >= 0) continue;
    const MarkerTrack& track = tracks->tracks[t];
    const TrackPrediction prediction = PredictByOthers(track, motions);
    AddLocated(search, track.marker_id, prediction.corners_px, prediction.margin_px, &quads);
  }
  quads = RemoveNested(std::move(quads));
  LocateExpected(search, &quads);
  Advance(quads, search.image_size, frame_number, tracks);
  tracks->has_new = num_new > 0;
  tracks->inflow_px = {};
  return quads;
}

}  // namespace velamap
