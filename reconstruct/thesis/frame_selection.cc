#include "reconstruct/thesis/frame_selection.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include "importer/base/error.h"

namespace velamap {
namespace {

// Frame numbers are computed with 64 bits, so that options of any size cannot overflow.
using FrameNumber = std::int64_t;

ShapePoints PointsOf(const FrameShape& frame) {
  ShapePoints points;
  for (const FrameMarker& marker : frame.markers) {
    points.emplace(marker.marker_id, marker.x_in_cam.front());
  }
  return points;
}

// Indices of the frames whose number lies within [first, last].
std::pair<int, int> FramesInWindow(const std::vector<FrameShape>& frames, FrameNumber first,
                                   FrameNumber last) {
  const auto by_number = [](const FrameShape& frame, FrameNumber number) {
    return *frame.frame_number < number;
  };
  const auto begin = std::lower_bound(frames.begin(), frames.end(), first, by_number);
  const auto end = std::lower_bound(begin, frames.end(), last + 1, by_number);
  return {static_cast<int>(begin - frames.begin()), static_cast<int>(end - frames.begin())};
}

// The thesis aligns every frame with the central one. If the camera has moved so far that no
// frame of a window aligns with it, `extended` takes its place: the markers of the central frame
// and of the frames found so far.
struct Search {
  const std::vector<FrameShape>& frames;
  const Layout& layout;
  const RegistrationOptions& options;
  ShapePoints central;
  ShapePoints extended;

  FrameNumber Number(int frame_idx) const {
    return *frames[static_cast<std::size_t>(frame_idx)].frame_number;
  }
};

std::optional<SelectedFrame> BestInWindow(const Search& search, const ShapePoints& shape,
                                          FrameNumber first_number, FrameNumber last_number,
                                          FrameNumber target_number) {
  std::optional<SelectedFrame> best;
  const auto [begin, end] = FramesInWindow(search.frames, first_number, last_number);
  for (int idx = begin; idx < end; ++idx) {
    auto candidate = AlignFrame(search.frames[static_cast<std::size_t>(idx)], shape, search.layout,
                                search.options);
    if (!candidate) continue;
    const std::size_t num_inliers = candidate->inlier_ids.size();
    const bool better = !best || num_inliers > best->alignment.inlier_ids.size() ||
                        (num_inliers == best->alignment.inlier_ids.size() &&
                         std::abs(search.Number(idx) - target_number) <
                             std::abs(search.Number(best->frame_idx) - target_number));
    if (better) best = SelectedFrame{idx, std::move(*candidate)};
  }
  return best;
}

// Walks from the central frame in one direction (+1 or -1).
void SearchOneSide(int central_idx, int direction, Search* search,
                   std::vector<SelectedFrame>* selected) {
  const ThesisRegistrationOptions& options = search->options.thesis;
  const FrameNumber skip = options.skip, neighborhood = options.neighborhood;
  const FrameNumber first_number = *search->frames.front().frame_number;
  const FrameNumber last_number = *search->frames.back().frame_number;
  FrameNumber from_number = search->Number(central_idx);
  for (int count = 0; count < options.num_frames;) {
    const FrameNumber target = from_number + direction * skip;
    // A window does not reach back across the frame that the skip started from.
    const FrameNumber nearest = direction > 0 ? std::max(target - neighborhood, from_number + 1)
                                              : std::min(target + neighborhood, from_number - 1);
    if (direction > 0 ? nearest > last_number : nearest < first_number) return;
    const FrameNumber furthest = target + direction * neighborhood;
    const auto [first, last] = std::minmax(nearest, furthest);
    auto best = BestInWindow(*search, search->central, first, last, target);
    if (!best && !options.IsExact()) {
      best = BestInWindow(*search, search->extended, first, last, target);
    }
    if (!best) {
      from_number = target;
      continue;
    }
    const FrameShape& frame = search->frames[static_cast<std::size_t>(best->frame_idx)];
    for (const FrameMarker& marker : frame.markers) {
      search->extended.emplace(marker.marker_id,
                               Transform(best->alignment.shape_from_cam, marker.x_in_cam.front()));
    }
    from_number = search->Number(best->frame_idx);
    selected->push_back(std::move(*best));
    ++count;
  }
}

}  // namespace

int NumSharedMarkers(const FrameShape& a, const FrameShape& b) {
  int count = 0;
  auto in_a = a.markers.begin();
  auto in_b = b.markers.begin();
  while (in_a != a.markers.end() && in_b != b.markers.end()) {
    if (in_a->marker_id == in_b->marker_id) {
      ++count, ++in_a, ++in_b;
    } else if (in_a->marker_id < in_b->marker_id) {
      ++in_a;
    } else {
      ++in_b;
    }
  }
  return count;
}

CentralFrame ChooseCentralFrame(const std::vector<FrameShape>& frames) {
  VELAMAP_CHECK(!frames.empty());
  // The number of frames that see each marker gives the shared markers of all frames in one pass.
  std::map<int, int> num_frames_of;
  for (const FrameShape& frame : frames) {
    for (const FrameMarker& marker : frame.markers) ++num_frames_of[marker.marker_id];
  }
  int best_idx = 0, best_shared = -1;
  for (std::size_t idx = 0; idx < frames.size(); ++idx) {
    int shared = 0;
    for (const FrameMarker& marker : frames[idx].markers) {
      shared += num_frames_of[marker.marker_id] - 1;
    }
    if (shared > best_shared) {
      best_shared = shared;
      best_idx = static_cast<int>(idx);
    }
  }
  return {best_idx, "its markers are seen " + std::to_string(best_shared) +
                        " times in the other images, more than any other image's"};
}

ThesisRegistrationOptions FitToVideo(const ThesisRegistrationOptions& options,
                                     int num_frames_on_side) {
  ThesisRegistrationOptions fitted = options;
  // Rounded to nearest: one frame less on a side costs less than leaving half a clip unused.
  const FrameNumber num_frames = std::max(options.num_frames, 1);
  fitted.skip = static_cast<int>(
      std::clamp<FrameNumber>((num_frames_on_side + num_frames / 2) / num_frames, 1, options.skip));
  if (fitted.skip < options.skip) {
    fitted.neighborhood = std::min(options.neighborhood, fitted.skip / 2);
  }
  return fitted;
}

std::pair<int, int> ReachableFrames(int central_frame_number,
                                    const ThesisRegistrationOptions& options) {
  constexpr FrameNumber kLastNumber = std::numeric_limits<int>::max();
  const FrameNumber reach = options.num_frames * (FrameNumber{options.skip} + options.neighborhood);
  return {static_cast<int>(std::max<FrameNumber>(central_frame_number - reach, 0)),
          static_cast<int>(std::min(central_frame_number + reach, kLastNumber))};
}

CentralFrame ChooseCentralVideoFrame(const std::vector<FrameShape>& frames,
                                     const ThesisRegistrationOptions& options) {
  VELAMAP_CHECK(!frames.empty());
  const FrameNumber first_number = *frames.front().frame_number;
  const FrameNumber last_number = *frames.back().frame_number;
  const FrameNumber skip = options.skip;
  const FrameNumber neighborhood =
      std::min<FrameNumber>(options.neighborhood, last_number - first_number);
  int best_idx = 0;
  FrameNumber best_shared = -1;
  for (std::size_t idx = 0; idx < frames.size(); ++idx) {
    const FrameNumber number = *frames[idx].frame_number;
    // Steps whose window lies before the first or behind the last frame share nothing.
    const FrameNumber num_before = (number - first_number + neighborhood) / skip;
    const FrameNumber num_behind = (last_number - number + neighborhood) / skip;
    FrameNumber shared = 0;
    for (FrameNumber step = -std::min<FrameNumber>(options.num_frames, num_before);
         step <= std::min<FrameNumber>(options.num_frames, num_behind); ++step) {
      if (step == 0) continue;
      const FrameNumber target = number + step * skip;
      const auto [begin, end] =
          FramesInWindow(frames, target - neighborhood, target + neighborhood);
      int most = 0;
      for (int other = begin; other < end; ++other) {
        most =
            std::max(most, NumSharedMarkers(frames[idx], frames[static_cast<std::size_t>(other)]));
      }
      shared += most;
    }
    if (shared > best_shared) {
      best_shared = shared;
      best_idx = static_cast<int>(idx);
    }
  }
  return {best_idx, "the best frames around it share " + std::to_string(best_shared) +
                        " markers with it, more than with any other frame"};
}

std::vector<SelectedFrame> SearchFrames(const std::vector<FrameShape>& frames, int central_idx,
                                        const Layout& layout, const RegistrationOptions& options) {
  const ThesisRegistrationOptions& thesis = options.thesis;
  VELAMAP_CHECK(thesis.num_frames >= 0 && thesis.skip >= 1 && thesis.neighborhood >= 0);
  const ShapePoints central = PointsOf(frames[static_cast<std::size_t>(central_idx)]);
  std::vector<SelectedFrame> selected;
  for (const int direction : {-1, 1}) {
    Search one_side{frames, layout, options, central, central};
    SearchOneSide(central_idx, direction, &one_side, &selected);
  }
  std::sort(selected.begin(), selected.end(), [](const SelectedFrame& a, const SelectedFrame& b) {
    return a.frame_idx < b.frame_idx;
  });
  return selected;
}

}  // namespace velamap
