#include "reconstruct/global/global_registration.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "importer/base/parallel.h"
#include "reconstruct/global/global_registration_report.h"
#include "reconstruct/global/global_registration_state.h"
#include "reconstruct/global/map_cleanup.h"
#include "reconstruct/global/view_selection.h"
#include "reconstruct/map/map_adjustment.h"
#include "reconstruct/map/map_growth.h"
#include "reconstruct/map/map_start.h"
#include "reconstruct/map/map_verdict.h"
#include "reconstruct/registration/dictionary_doubt.h"
#include "reconstruct/registration/frame_order.h"
#include "reconstruct/registration/repeated_frames.h"

namespace velamap {
namespace {

// Frames on which maps grow from several starts.
constexpr int kMaxStartFrames = 32;

// The frames of a video without those that repeat the one before. Many copies of one frame would
// outvote all others, which do not share its errors.
std::vector<int> FramesThatDiffer(GlobalRegistration* global) {
  const std::vector<bool> is_repeated = FindRepeatedFrames(global->images);
  std::vector<int> differ;
  for (std::size_t i = 0; i < is_repeated.size(); ++i) {
    if (is_repeated[i]) {
      global->left_out_of_image[i].reason = "repeats the frame before";
    } else {
      differ.push_back(static_cast<int>(i));
    }
  }
  if (differ.size() < 2) {
    throw DataError(
        fmt::format("all {} frames with markers show the same picture; film again, and move the "
                    "camera around the object",
                    is_repeated.size()));
  }
  return differ;
}

// Chooses among the frames with these indices.
std::vector<int> ChooseCandidates(const GlobalRegistration& global, const std::vector<int>& idxs,
                                  std::size_t max_num_candidates) {
  std::vector<const DatabaseImage*> images;
  for (const int idx : idxs) images.push_back(global.images[static_cast<std::size_t>(idx)]);
  std::vector<int> candidates;
  for (const int place : ChooseCandidateFrames(images, max_num_candidates)) {
    candidates.push_back(idxs[static_cast<std::size_t>(place)]);
  }
  return candidates;
}

// Registers twice as many frames of a video as are kept, so that the best can be chosen.
void ChooseFrames(GlobalRegistration* global) {
  constexpr std::size_t kCandidatesPerFrame = 2;
  std::vector<int> chosen(global->images.size());
  std::iota(chosen.begin(), chosen.end(), 0);
  const std::size_t max_num_candidates =
      kCandidatesPerFrame * static_cast<std::size_t>(global->options.global.max_num_frames);
  global->left_out_of_image.assign(
      global->images.size(),
      {LeftOut::Cause::kNotTried, "frames next to it show more markers or are sharper"});
  if (global->is_video) {
    chosen = FramesThatDiffer(global);
    if (chosen.size() > max_num_candidates) {
      chosen = ChooseCandidates(*global, chosen, max_num_candidates);
    }
    const auto place = std::lower_bound(chosen.begin(), chosen.end(), global->central_image_idx);
    if (global->central_image_idx >= 0 &&
        (place == chosen.end() || *place != global->central_image_idx)) {
      chosen.insert(place, global->central_image_idx);
    }
  }
  for (const int idx : chosen) global->left_out_of_image[static_cast<std::size_t>(idx)] = {};
  global->image_idx_of_frame = std::move(chosen);
}

// Frames at even distances over a video, or all photographs, because any may be the only link.
std::vector<int> FramesForStarts(const GlobalRegistration& global) {
  const int num_frames = static_cast<int>(global.problem.frames.size());
  const int step =
      global.is_video ? std::max(1, (num_frames + kMaxStartFrames - 1) / kMaxStartFrames) : 1;
  std::vector<int> frame_idxs;
  for (int idx = 0; idx < num_frames; idx += step) frame_idxs.push_back(idx);
  return frame_idxs;
}

MapSolution GrowFromStart(const GlobalRegistration& global, const std::vector<int>& frame_idxs,
                          const std::pair<int, int>& pair) {
  MapGrowthOptions growth = global.Growth();
  growth.max_num_frames = kMaxStartFrames;
  growth.num_threads = 1;  // the starts share the threads
  MapSolution solution = StartFromPair(global.problem, pair, growth.random_seed);
  if (solution.NumRegistered() == 2) GrowMap(global.problem, frame_idxs, growth, &solution);
  return solution;
}

// Grows a map from every start and returns the one that explains most. Starts are judged in pairs:
// if a map of a pair explains as much as the best one so far, and that shows no sign of a wrong
// shape, the other starts are not needed. The order in which maps are judged does not depend on the
// number of threads.
MapSolution GrowBestMap(const GlobalRegistration& global) {
  constexpr double kSame = 0.01;
  const MapProblem& problem = global.problem;
  const std::vector<int> frame_idxs = FramesForStarts(global);
  const auto pairs = ChooseStartPairs(problem, frame_idxs, global.options.global.num_starts,
                                      global.options.min_num_inliers);
  const std::size_t num_at_once =
      2 * ((static_cast<std::size_t>(NumThreads(global.options.num_threads)) + 1) / 2);
  std::vector<MapSolution> solutions(pairs.size());
  MapSolution best = EmptySolution(problem);
  double most_explained = 0.0;
  int num_same = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i % num_at_once == 0) {
      ParallelFor(std::min(num_at_once, pairs.size() - i), global.options.num_threads,
                  [&](std::size_t k) {
                    solutions[i + k] = GrowFromStart(global, frame_idxs, pairs[i + k]);
                  });
    }
    const double explained = ExplainedObservations(problem, solutions[i]);
    LogDebug("start from {} and {}: {} frames, {:.1f} observations explained",
             problem.Frame(pairs[i].first).image->detections.image_name,
             problem.Frame(pairs[i].second).image->detections.image_name,
             solutions[i].NumRegistered(), explained);
    num_same += std::abs(explained - most_explained) < kSame * most_explained;
    if (explained > most_explained) {
      most_explained = explained;
      best = std::move(solutions[i]);
    }
    if (i % 2 == 0) continue;
    if (num_same > 0 && !IsSuspicious(EstimateNoise(problem, best))) break;
    num_same = 0;
  }
  return best;
}

// Also adjusts the reversed relief and returns it if it explains more. A relief that explains less
// than half after a first adjustment is given up, because new places of markers and another
// adjustment add less than a tenth.
void TryReversedRelief(const MapProblem& problem, int num_threads, MapSolution* solution) {
  constexpr double kRoughly = 4.0, kHopeless = 0.5;
  MapSolution reversed = ReversedRelief(*solution);
  MarkInliers(problem, kRoughly, &reversed);
  AdjustMap(problem, {15, 1e-3}, &reversed);
  const double explained = ExplainedObservations(problem, *solution);
  if (ExplainedObservations(problem, reversed) < kHopeless * explained) return;
  MarkInliers(problem, 1.0, &reversed);
  PlaceUnsettledMarkers(problem, 1.0, 1.0, num_threads, &reversed);
  AdjustMap(problem, {15, 1e-3}, &reversed);
  if (ExplainedObservations(problem, reversed) > explained) {
    *solution = std::move(reversed);
    MarkInliers(problem, 1.0, solution);
  }
}

// Registers all frames that can be registered, leaves out those that add little, and places markers
// by the consensus of all frames.
void RegisterAllFrames(GlobalRegistration* global) {
  constexpr double kSettledRatio = 0.9;
  const MapProblem& problem = global->problem;
  TryReversedRelief(problem, global->options.num_threads, &global->solution);
  std::vector<int> all(problem.frames.size());
  std::iota(all.begin(), all.end(), 0);
  MapGrowthOptions growth = global->Growth();
  // More frames of a video are registered than are kept; the others need no adjustment.
  growth.adjust = !global->is_video;
  GrowMap(problem, all, growth, &global->solution);
  PlaceUnsettledMarkers(problem, kSettledRatio, 1.0, global->options.num_threads,
                        &global->solution);
  VoteOnIds(global);
  global->noise = EstimateNoise(problem, global->solution);
  LeaveOutBlurredFrames(global);
  LimitFrames(global);
  AdjustMap(problem, {10, 1e-3}, &global->solution);
  MarkInliers(problem, 1.0, &global->solution);
}

// Adjusts until a step changes the cost by less than the fraction `tolerance`, and marks the
// inliers.
void AdjustFinally(double tolerance, GlobalRegistration* global) {
  AdjustMap(global->problem, {50, tolerance}, &global->solution);
  global->noise = EstimateNoise(global->problem, global->solution);
  MarkFinalInliers(global->problem, global->noise, &global->solution);
}

// Removes outliers at the tolerance of the final noise, and adjusts. Markers that the layout
// contradicts are removed before the last adjustment, so that they do not affect the result.
void RemoveOutliers(const Layout& layout, GlobalRegistration* global) {
  const MapProblem& problem = global->problem;
  DropWrongSizes(global);
  global->noise = EstimateNoise(problem, global->solution);
  LeaveOutBlurredFrames(global);
  MarkFinalInliers(problem, global->noise, &global->solution);
  DropUnsupported(global);
  constexpr double kRough = 1e-3, kFine = 1e-6;
  AdjustFinally(kRough, global);
  DropContradictions(layout, global);
  DropUnsupported(global);
  AdjustFinally(kFine, global);
  if (DropContradictions(layout, global)) AdjustFinally(kFine, global);
  DropUnsupported(global);
  if (global->is_video) MarkMovedViews(problem, &global->solution);
}

int ChooseCentralFrame(const GlobalRegistration& global) {
  int central_idx = -1, most_shared = -1;
  for (int idx = 0; idx < static_cast<int>(global.problem.frames.size()); ++idx) {
    if (!global.solution.Pose(idx)) continue;
    int shared = 0;
    for (const int observation_idx : global.problem.Frame(idx).observation_idxs) {
      if (!global.solution.IsInlier(observation_idx)) continue;
      shared += global.NumInliers(global.problem.Observation(observation_idx).marker_idx) - 1;
    }
    if (shared > most_shared) {
      most_shared = shared;
      central_idx = idx;
    }
  }
  return central_idx;
}

[[noreturn]] void ThrowNoAgreement(const std::vector<DatabaseImage>& images,
                                   const RegistrationOptions& options) {
  const std::string doubt = DictionaryDoubt(images);
  throw DataError(fmt::format(
      "no two images agree on the places of at least {} markers that both see; {}check that {}the "
      "marker length is right, and that the pictures overlap",
      options.min_num_inliers,
      doubt.empty()
          ? ""
          : doubt + ", which happens with a wrong dictionary and in pictures too blurred or dim to "
                    "read: first check the dictionary, its border_bits and whether the prints are "
                    "inverted, and let velamap clip_checker judge the pictures; if these are "
                    "right, ",
      options.has_calibration ? "the camera calibration belongs to these images, that " : ""));
}

}  // namespace

Registration RegisterFramesGlobally(const std::vector<DatabaseImage>& images,
                                    const std::map<CameraId, Camera>& cameras, const Layout& layout,
                                    const RegistrationOptions& options) {
  options.Check();
  GlobalRegistration global{options, CanonicalOrder(images), {}, false, -1, {}, {}, {}, {}, {}, {}};
  CheckEnoughImages(global.images.size(), 2);
  global.is_video = UseTimeOrder(global.images, options.frame_order);
  if (!options.central_frame.empty()) {
    global.central_image_idx = FindCentralFrame(global.images, options);
  }
  ChooseFrames(&global);
  std::vector<const DatabaseImage*> chosen;
  for (const int idx : global.image_idx_of_frame) {
    chosen.push_back(global.images[static_cast<std::size_t>(idx)]);
  }
  global.problem = MakeMapProblem(chosen, cameras, layout, options.num_threads);
  global.solution = GrowBestMap(global);
  if (global.solution.NumRegistered() >= 2) {
    RegisterAllFrames(&global);
    RemoveOutliers(layout, &global);
  }
  if (global.solution.NumRegistered() < 2) {
    ThrowNoAgreement(images, options);
  }
  if (IsSuspicious(global.noise)) {
    global.notes.push_back(fmt::format(
        "the errors of the registered map ({:.2f} px) are larger than the noise of the corners "
        "({:.2f} px) explains: the shape may be wrong, or the surface moved; take views from "
        "more directions",
        global.noise.sigma_px, global.noise.single_marker_sigma_px));
  }
  LogDebug("noise of the map {:.3f} px, of single markers {:.3f} px", global.noise.sigma_px,
           global.noise.single_marker_sigma_px);
  int central_idx = ChooseCentralFrame(global);
  if (global.central_image_idx >= 0) {
    const auto named = std::find(global.image_idx_of_frame.begin(), global.image_idx_of_frame.end(),
                                 global.central_image_idx);
    central_idx = static_cast<int>(named - global.image_idx_of_frame.begin());
    if (!global.solution.Pose(central_idx)) {
      throw InputError(OptionName(&RegistrationOptions::central_frame) + " " +
                       options.central_frame +
                       ": the image cannot be registered with the others; leave the option out to "
                       "let the best one be chosen");
    }
  }
  return MakeRegistration(central_idx, std::move(global));
}

}  // namespace velamap
