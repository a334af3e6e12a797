#include "workflows/check/clip_parts.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "importer/base/statistics.h"
#include "importer/geometry/units.h"
#include "workflows/check/clip_limits.h"
#include "workflows/check/clip_precision.h"

namespace velamap {
namespace {

constexpr std::size_t kFewMarkersOfFrame = 4;
constexpr int kMaxPoorBetween = 2;  // frames
constexpr int kSeenAgain = 2;       // frames that have to see a marker to place it in space

enum class FrameFault { kNone, kLacksMarkers, kContradicts, kBlurred };

const char* FaultText(FrameFault fault) {
  switch (fault) {
    case FrameFault::kLacksMarkers:
      return "fewer than four markers";
    case FrameFault::kContradicts:
      return "contradicts the other frames";
    case FrameFault::kBlurred:
      return "blurred";
    default:
      return "";
  }
}

struct LookedAtFrame {
  int number = 0;
  double time_s = 0.0;
  const FrameDetections* seen = nullptr;  // null: no markers
  FrameFault fault = FrameFault::kNone;
};

// 0 for corners without a fit.
double SigmaOf(const MarkerDetection& marker) {
  const auto& sigmas_px = marker.corner_sigma_px;
  return std::accumulate(sigmas_px.begin(), sigmas_px.end(), 0.0) / kNumCorners;
}

// The sigma of each marker's corners in the sharpest quarter of the frames that show it.
std::map<int, double> SharpSigmas(const std::vector<DatabaseImage>& images) {
  std::map<int, std::vector<double>> sigmas_px;
  for (const DatabaseImage& image : images) {
    for (const MarkerDetection& marker : image.detections.markers) {
      if (SigmaOf(marker) > 0) sigmas_px[marker.marker_id].push_back(SigmaOf(marker));
    }
  }
  std::map<int, double> sharp_px;
  for (auto& [marker_id, values] : sigmas_px) {
    const auto quartile = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
    std::nth_element(values.begin(), quartile, values.end());
    sharp_px[marker_id] = *quartile;
  }
  return sharp_px;
}

bool IsBlurred(const FrameDetections& frame, const std::map<int, double>& sharp_px) {
  constexpr double kBlurredRatio = 2.0;
  std::vector<double> ratios;
  for (const MarkerDetection& marker : frame.markers) {
    const double sigma_px = SigmaOf(marker);
    if (sigma_px > 0) ratios.push_back(sigma_px / sharp_px.at(marker.marker_id));
  }
  return !ratios.empty() && Median(std::move(ratios)) > kBlurredRatio;
}

std::vector<LookedAtFrame> LookAtFrames(const std::vector<DatabaseImage>& images,
                                        const FrameTimes& times, const ClipPrecision* precision) {
  std::map<int, const FrameDetections*> by_number;
  for (const DatabaseImage& image : images) {
    if (image.detections.frame_number) {
      by_number[*image.detections.frame_number] = &image.detections;
    }
  }
  const std::map<int, double> sharp_px = SharpSigmas(images);
  std::vector<LookedAtFrame> frames;
  for (int i = 0; i < times.num_frames; ++i) {
    LookedAtFrame frame;
    frame.number = times.first_frame + i * times.frame_step;
    frame.time_s = times.first_s + i * times.frame_step * times.seconds_per_frame;
    if (const auto found = by_number.find(frame.number); found != by_number.end()) {
      frame.seen = found->second;
      frame.time_s = frame.seen->time_s.value_or(frame.time_s);
    }
    if (frame.seen == nullptr || frame.seen->markers.size() < kFewMarkersOfFrame) {
      frame.fault = FrameFault::kLacksMarkers;
    } else if (precision != nullptr &&
               precision->contradicting_images.count(frame.seen->image_name) > 0) {
      frame.fault = FrameFault::kContradicts;
    } else if (IsBlurred(*frame.seen, sharp_px)) {
      frame.fault = FrameFault::kBlurred;
    }
    frames.push_back(frame);
  }
  return frames;
}

std::size_t NumShared(const FrameDetections& a, const FrameDetections& b) {
  std::set<int> ids;
  for (const MarkerDetection& marker : a.markers) ids.insert(marker.marker_id);
  return static_cast<std::size_t>(std::count_if(
      b.markers.begin(), b.markers.end(),
      [&](const MarkerDetection& marker) { return ids.count(marker.marker_id) > 0; }));
}

using Run = std::vector<const LookedAtFrame*>;

// Runs of frames without a fault, each of which shares enough markers with the one before.
std::vector<Run> FindRuns(const std::vector<LookedAtFrame>& frames) {
  std::vector<Run> runs;
  const LookedAtFrame* last = nullptr;
  for (const LookedAtFrame& frame : frames) {
    if (frame.fault != FrameFault::kNone) continue;
    const bool continues = last != nullptr && &frame - last <= kMaxPoorBetween + 1 &&
                           NumShared(*last->seen, *frame.seen) >= kFewMarkersOfFrame;
    if (!continues) runs.emplace_back();
    runs.back().push_back(&frame);
    last = &frame;
  }
  return runs;
}

std::set<int> MarkersSeenAgain(const Run& run) {
  std::map<int, int> num_frames_of_id;
  for (const LookedAtFrame* frame : run) {
    for (const MarkerDetection& marker : frame->seen->markers) {
      ++num_frames_of_id[marker.marker_id];
    }
  }
  std::set<int> ids;
  for (const auto& [marker_id, num_frames] : num_frames_of_id) {
    if (num_frames >= kSeenAgain) ids.insert(marker_id);
  }
  return ids;
}

// What a run lacks of the markers that all runs together show, by part of the layout.
std::string LackingMarkers(const std::set<int>& ids, const std::set<int>& all_ids,
                           const Layout& layout) {
  std::map<std::string, std::pair<int, int>> missing_and_all;
  for (const int marker_id : all_ids) {
    auto& [num_missing, num_all] = missing_and_all[PartOfMarker(layout, marker_id)];
    ++num_all;
    num_missing += ids.count(marker_id) == 0;
  }
  for (const auto& [part, nums] : missing_and_all) {
    const auto [num_missing, num_all] = nums;
    if (4 * num_missing <= num_all) continue;
    return fmt::format("lacks {} of {} markers{}", num_missing, num_all,
                       part.empty() ? "" : " of " + part);
  }
  return "";
}

std::optional<double> ParallaxOf(const Run& run, const ClipPrecision* precision) {
  if (precision == nullptr) return std::nullopt;
  std::vector<Eigen::Vector3d> directions;
  for (const LookedAtFrame* frame : run) {
    const auto found = precision->directions.find(frame->seen->image_name);
    if (found != precision->directions.end()) directions.push_back(found->second);
  }
  return kDegPerRad * LargestAngle(directions);
}

ClipPart PartOf(const Run& run, const std::set<int>& all_ids, const Layout& layout,
                const ClipPrecision* precision) {
  ClipPart part{run.front()->time_s, run.back()->time_s, run.front()->number, run.back()->number};
  const std::set<int> ids = MarkersSeenAgain(run);
  part.num_markers = static_cast<int>(ids.size());
  part.parallax_deg = ParallaxOf(run, precision);
  if (run.size() < 2) {
    part.lacks = "a single frame";
  } else if (part.parallax_deg && *part.parallax_deg < kGoodParallax_deg) {
    part.lacks = fmt::format("only {:.0f} degrees around the object", *part.parallax_deg);
  } else {
    part.lacks = LackingMarkers(ids, all_ids, layout);
  }
  return part;
}

// The frames from `begin` to before `end`, which are in no run; named after their commonest fault.
ClipPart PoorPart(const LookedAtFrame* begin, const LookedAtFrame* end) {
  std::map<FrameFault, int> nums;
  for (const LookedAtFrame* frame = begin; frame != end; ++frame) ++nums[frame->fault];
  const auto most = std::max_element(
      nums.begin(), nums.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const LookedAtFrame* last = end - 1;
  return {begin->time_s, last->time_s, begin->number, last->number, FaultText(most->first)};
}

// Joins poor frames to those before with the same fault.
void Append(const ClipPart& part, std::vector<ClipPart>* parts) {
  if (part.num_markers == 0 && !parts->empty() && parts->back().lacks == part.lacks) {
    parts->back().end_s = part.end_s;
    parts->back().last_frame = part.last_frame;
  } else {
    parts->push_back(part);
  }
}

}  // namespace

std::vector<ClipPart> FindClipParts(const std::vector<DatabaseImage>& images,
                                    const FrameTimes& times, const Layout& layout,
                                    const ClipPrecision* precision) {
  const std::vector<LookedAtFrame> frames = LookAtFrames(images, times, precision);
  const std::vector<Run> runs = FindRuns(frames);
  std::set<int> all_ids;
  for (const Run& run : runs) all_ids.merge(MarkersSeenAgain(run));
  std::vector<ClipPart> parts;
  const LookedAtFrame* next = frames.data();
  for (const Run& run : runs) {
    if (next < run.front()) Append(PoorPart(next, run.front()), &parts);
    Append(PartOf(run, all_ids, layout, precision), &parts);
    next = run.back() + 1;
  }
  const LookedAtFrame* end = frames.data() + frames.size();
  if (next < end) Append(PoorPart(next, end), &parts);
  return parts;
}

}  // namespace velamap
