#include "reconstruct/global/map_cleanup.h"

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "reconstruct/evidence/layout_evidence.h"
#include "reconstruct/global/view_selection.h"
#include "reconstruct/map/map_intersection.h"
#include "reconstruct/map/map_verdict.h"

namespace velamap {
namespace {

// Print errors do not change a side by more than this factor relative to the median of the others.
constexpr double kMaxSizeRatio = 1.25;
// An id is in two places when the second has at least this fraction of the support of the first.
constexpr double kRivalRatio = 0.6;
// A frame is left out when its corners scatter this many times as much as all corners.
constexpr double kBlurRatio = 3.0;
// The poses of its single markers show whether blur is the reason: lens and cloth alone make the
// errors at most this many times as large as the noise of the corners.
constexpr double kMaxRatioToOwnNoise = 2.0;
constexpr int kMinViewsWithoutBlurred = 3;

// Whether the observation would be an inlier of marker `as_marker_idx`, with its corners renumbered
// by `quarters` turns.
bool IsInlierAs(const GlobalRegistration& global, int observation_idx, int as_marker_idx,
                int quarters) {
  const MapObservation& observation = global.problem.Observation(observation_idx);
  return ErrorAs(global.problem, global.solution, observation, as_marker_idx, quarters) <=
         GrowthTolerance(observation);
}

// The same for any number of turns from `min_quarters` on.
bool IsInlierRenumbered(const GlobalRegistration& global, int observation_idx, int as_marker_idx,
                        int min_quarters) {
  for (int quarters = min_quarters; quarters < kNumCorners; ++quarters) {
    if (IsInlierAs(global, observation_idx, as_marker_idx, quarters)) return true;
  }
  return false;
}

// Whether these observations of one marker show another marker, which far more frames see. The id
// was then misread here.
bool SeeAnotherMarker(const GlobalRegistration& global, int marker_idx,
                      const std::vector<int>& observation_idxs) {
  const auto count = static_cast<double>(observation_idxs.size());
  for (int other_idx = 0; other_idx < static_cast<int>(global.problem.markers.size());
       ++other_idx) {
    if (other_idx == marker_idx || global.solution.Places(other_idx).empty() ||
        count >= kRivalRatio * global.NumInliers(other_idx)) {
      continue;
    }
    if (std::all_of(observation_idxs.begin(), observation_idxs.end(), [&](int observation_idx) {
          return IsInlierAs(global, observation_idx, other_idx, 0);
        })) {
      return true;
    }
  }
  return false;
}

// Whether the observations see the marker at its place with wrongly numbered corners. This does not
// count as a second place.
bool SeeMarkerRotated(const GlobalRegistration& global, int marker_idx,
                      const std::vector<int>& observation_idxs) {
  if (global.solution.Places(marker_idx).empty()) return false;
  return std::all_of(observation_idxs.begin(), observation_idxs.end(), [&](int observation_idx) {
    return IsInlierRenumbered(global, observation_idx, marker_idx, 1);
  });
}

// The markers whose places explain all inliers of this marker, from whichever corner they are
// numbered: a misread code may start at any corner.
std::vector<int> RivalsOf(const GlobalRegistration& global, int marker_idx) {
  std::vector<int> rival_ids;
  for (int other_idx = 0; other_idx < static_cast<int>(global.problem.markers.size());
       ++other_idx) {
    if (other_idx == marker_idx || global.solution.Places(other_idx).empty()) {
      continue;
    }
    const auto& observation_idxs = global.problem.Marker(marker_idx).observation_idxs;
    if (std::all_of(observation_idxs.begin(), observation_idxs.end(), [&](int observation_idx) {
          return !global.solution.IsInlier(observation_idx) ||
                 IsInlierRenumbered(global, observation_idx, other_idx, 0);
        })) {
      rival_ids.push_back(global.problem.Marker(other_idx).marker_id);
    }
  }
  return rival_ids;
}

// Leaves out a frame whose corners scatter `ratio` times as much as those of the other frames.
void LeaveOutScattered(int frame_idx, double ratio, GlobalRegistration* global) {
  const auto idx = static_cast<std::size_t>(frame_idx);
  const MapNoise& noise = global->noise;
  const bool is_blurred =
      noise.factor_of_frame[idx] <= kMaxRatioToOwnNoise * noise.single_marker_factor_of_frame[idx];
  if (!is_blurred) {
    global->num_contradicting_of_frame[frame_idx] =
        NumKnown(global->problem, global->solution, frame_idx);
  }
  global->LeaveOut(
      frame_idx,
      {LeftOut::Cause::kUnfit,
       fmt::format("its corners scatter {:.0f} times as much as the other images': {}", ratio,
                   is_blurred ? "blurred, or the surface moved"
                              : "sharp, but of another camera, lens mode or zoom, or the surface "
                                "or the camera moved during the exposure")});
}

}  // namespace

void VoteOnIds(GlobalRegistration* global) {
  constexpr double kBeyondDoubt = 0.8;
  for (std::size_t idx = 0; idx < global->problem.markers.size(); ++idx) {
    const int marker_idx = static_cast<int>(idx);
    if (IsSettled(global->problem, global->solution, marker_idx, kBeyondDoubt)) continue;
    const MarkerPlacement placement =
        PlaceMarker(global->problem, global->solution, marker_idx, 1.0);
    if (placement.places.empty()) continue;
    const int num_here = static_cast<int>(placement.places.front().inlier_idxs.size());
    const std::vector<int>& elsewhere_idxs = placement.elsewhere_idxs;
    const int num_elsewhere = static_cast<int>(elsewhere_idxs.size());
    if (num_elsewhere < kRivalRatio * num_here ||
        SeeAnotherMarker(*global, marker_idx, elsewhere_idxs) ||
        (num_elsewhere < num_here && SeeMarkerRotated(*global, marker_idx, elsewhere_idxs))) {
      continue;
    }
    global->Drop(marker_idx, fmt::format("its id is seen in two places, in {} and in {} frames, "
                                         "and nothing decides between them",
                                         num_here, num_elsewhere));
  }
}

void DropWrongSizes(GlobalRegistration* global) {
  const double median_scale = global->MedianMarkerScale();
  for (std::size_t idx = 0; idx < global->problem.markers.size(); ++idx) {
    const auto& places = global->solution.shape_from_marker[idx];
    if (places.empty()) continue;
    const double ratio = places.front().scale / median_scale;
    if (ratio < kMaxSizeRatio && ratio > 1 / kMaxSizeRatio) continue;
    global->Drop(static_cast<int>(idx),
                 fmt::format("its side is {:.2f} times as long as marker_length: a "
                             "marker of another size, or a false square with its id",
                             ratio));
    global->dropped_markers[static_cast<int>(idx)].size_ratio = ratio;
  }
}

bool DropContradictions(const Layout& layout, GlobalRegistration* global) {
  const double m_per_unit = 1 / global->MedianMarkerScale();
  std::vector<PlacedMarker> markers;
  std::map<int, int> marker_idx_of;
  for (std::size_t idx = 0; idx < global->problem.markers.size(); ++idx) {
    const int marker_idx = static_cast<int>(idx);
    if (global->solution.shape_from_marker[idx].empty() || global->NumInliers(marker_idx) == 0) {
      continue;
    }
    PlacedMarker marker = SupportOf(global->problem, global->solution, global->noise, marker_idx);
    marker.center_in_shape_m *= m_per_unit;
    marker.sigma_m *= m_per_unit;
    marker.rival_ids = RivalsOf(*global, marker_idx);
    marker_idx_of[marker.marker_id] = marker_idx;
    markers.push_back(std::move(marker));
  }
  const std::vector<Contradiction> contradictions = FindContradictions(layout, markers);
  for (const Contradiction& contradiction : contradictions) {
    const int marker_idx = marker_idx_of.at(contradiction.marker_id);
    global->Drop(marker_idx, contradiction.reason);
    global->dropped_markers.at(marker_idx).is_false = true;
  }
  return !contradictions.empty();
}

void LeaveOutBlurredFrames(GlobalRegistration* global) {
  const double general_factor = std::max(global->noise.factor, kMinNoiseFactor);
  for (std::size_t idx = 0; idx < global->problem.frames.size(); ++idx) {
    const double factor = global->noise.factor_of_frame[idx];
    if (!global->solution.cam_from_shape[idx] || factor < kBlurRatio * general_factor ||
        global->image_idx_of_frame[idx] == global->central_image_idx) {
      continue;
    }
    const auto& observation_idxs = global->problem.frames[idx].observation_idxs;
    const bool is_needed = std::any_of(
        observation_idxs.begin(), observation_idxs.end(), [global](int observation_idx) {
          return global->solution.IsInlier(observation_idx) &&
                 global->NumInliers(global->problem.Observation(observation_idx).marker_idx) <=
                     kMinViewsWithoutBlurred;
        });
    if (is_needed) continue;
    LeaveOutScattered(static_cast<int>(idx), factor / general_factor, global);
  }
}

void LimitFrames(GlobalRegistration* global) {
  const MapProblem& problem = global->problem;
  if (!global->is_video ||
      global->solution.NumRegistered() <= global->options.global.max_num_frames) {
    return;
  }
  std::vector<double> sigma_factor_of_frame;
  int first_idx = -1, most_inliers = -1;
  for (std::size_t idx = 0; idx < problem.frames.size(); ++idx) {
    sigma_factor_of_frame.push_back(std::max(global->noise.factor_of_frame[idx], 1e-9));
    if (!global->solution.cam_from_shape[idx]) continue;
    const bool is_named = global->image_idx_of_frame[idx] == global->central_image_idx;
    const int num_inliers = is_named ? static_cast<int>(problem.observations.size()) + 1
                                     : global->NumInliersInFrame(static_cast<int>(idx));
    if (num_inliers > most_inliers) {
      most_inliers = num_inliers;
      first_idx = static_cast<int>(idx);
    }
  }
  const std::vector<int> chosen = ChooseViews(problem, global->solution, sigma_factor_of_frame,
                                              first_idx, global->options.global.max_num_frames);
  for (int idx = 0; idx < static_cast<int>(problem.frames.size()); ++idx) {
    if (global->solution.Pose(idx) && !std::binary_search(chosen.begin(), chosen.end(), idx)) {
      global->LeaveOut(
          idx, {LeftOut::Cause::kAddsLittle, "adds less to the precision than the chosen frames"});
    }
  }
}

void DropUnsupported(GlobalRegistration* global) {
  const int min_num_frames =
      std::min(global->options.min_num_frames, global->solution.NumRegistered());
  for (bool changed = true; changed;) {
    changed = false;
    for (int idx = 0; idx < static_cast<int>(global->problem.markers.size()); ++idx) {
      if (global->solution.Places(idx).empty() || global->NumInliers(idx) >= min_num_frames) {
        continue;
      }
      global->Drop(idx, fmt::format("seen in {} registered frames; {} are needed",
                                    global->NumInliers(idx), min_num_frames));
      changed = true;
    }
    for (int idx = 0; idx < static_cast<int>(global->problem.frames.size()); ++idx) {
      if (!global->solution.Pose(idx) ||
          global->NumInliersInFrame(idx) >= global->options.min_num_inliers) {
        continue;
      }
      global->num_contradicting_of_frame[idx] =
          NumKnown(global->problem, global->solution, idx) - global->NumInliersInFrame(idx);
      global->LeaveOut(
          idx, {LeftOut::Cause::kUnfit,
                fmt::format("{} of its {} markers agree with the other images; {} are needed",
                            global->NumInliersInFrame(idx),
                            global->problem.Frame(idx).observation_idxs.size(),
                            global->options.min_num_inliers)});
      changed = true;
    }
  }
}

}  // namespace velamap
