#include "reconstruct/thesis/registration_state.h"

#include <algorithm>
#include <map>

#include "reconstruct/thesis/shape_averaging.h"

namespace velamap {
namespace {

// Rounds of aligning every frame with the mean shape and averaging the shape.
constexpr int kNumRefinements = 4;

// Images with at least this fraction of the best image's inliers are added in the same round.
constexpr double kJoinShare = 0.8;

// The pose solutions of every marker in the shape frame, by all registered frames in which it is no
// outlier.
std::map<int, std::vector<MarkerSolutions>> CollectSolutions(const RegistrationState& state) {
  std::map<int, std::vector<MarkerSolutions>> solutions_of;
  for (std::size_t idx = 0; idx < state.frames.size(); ++idx) {
    const auto& alignment = state.alignments[idx];
    if (!alignment) continue;
    for (const FrameMarker& marker : state.frames[idx].markers) {
      if (IsOutlier(*alignment, marker.marker_id)) continue;
      MarkerSolutions solutions;
      for (const MarkerPoints& x_in_cam : marker.x_in_cam) {
        solutions.push_back(Transform(alignment->shape_from_cam, x_in_cam));
        if (state.options.thesis.IsExact()) break;  // the better one alone, as ArUco gives it
      }
      solutions_of[marker.marker_id].push_back(std::move(solutions));
    }
  }
  return solutions_of;
}

void AverageShape(RegistrationState* state) {
  state->shape.clear();
  for (const auto& [marker_id, solutions] : CollectSolutions(*state)) {
    state->shape.emplace(marker_id, AverageMarker(solutions, state->options.thesis));
  }
}

void StartAtCentralFrame(int central_idx, RegistrationState* state) {
  state->alignments.assign(state->frames.size(), std::nullopt);
  state->alignments[static_cast<std::size_t>(central_idx)] = FrameAlignment{};
  AverageShape(state);
}

}  // namespace

int RegistrationState::NumRegistered() const {
  return static_cast<int>(std::count_if(alignments.begin(), alignments.end(),
                                        [](const auto& a) { return a.has_value(); }));
}

void GrowFromCentralFrame(int central_idx, RegistrationState* state) {
  StartAtCentralFrame(central_idx, state);
  while (true) {
    std::map<std::size_t, FrameAlignment> candidates;
    std::size_t most_inliers = 0;
    for (std::size_t idx = 0; idx < state->frames.size(); ++idx) {
      if (state->alignments[idx]) continue;
      auto alignment = AlignFrame(state->frames[idx], state->shape, state->layout, state->options);
      if (!alignment) continue;
      most_inliers = std::max(most_inliers, alignment->inlier_ids.size());
      candidates.emplace(idx, std::move(*alignment));
    }
    if (candidates.empty()) return;
    for (auto& [idx, alignment] : candidates) {
      if (static_cast<double>(alignment.inlier_ids.size()) >=
          kJoinShare * static_cast<double>(most_inliers)) {
        state->alignments[idx] = std::move(alignment);
      }
    }
    AverageShape(state);
  }
}

void SearchInTimeOrder(int central_idx, RegistrationState* state, std::vector<std::string>* notes) {
  StartAtCentralFrame(central_idx, state);
  auto selected_frames = SearchFrames(state->frames, central_idx, state->layout, state->options);
  const std::size_t num_wanted = 2 * static_cast<std::size_t>(state->options.thesis.num_frames);
  if (selected_frames.size() < num_wanted) {
    notes->push_back("the search found " + std::to_string(selected_frames.size()) + " of " +
                     std::to_string(num_wanted) +
                     " frames around the central one: the video ends, or no frame aligns");
  }
  for (SelectedFrame& selected : selected_frames) {
    state->alignments[static_cast<std::size_t>(selected.frame_idx)] = std::move(selected.alignment);
  }
  AverageShape(state);
}

void RefineShape(RegistrationState* state) {
  for (int round = 0; round < kNumRefinements; ++round) {
    for (std::size_t idx = 0; idx < state->frames.size(); ++idx) {
      auto& alignment = state->alignments[idx];
      if (!alignment) continue;
      alignment = AlignFrame(state->frames[idx], state->shape, state->layout, state->options);
    }
    AverageShape(state);
  }
}

}  // namespace velamap
