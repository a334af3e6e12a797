// Removes markers and frames that do not belong in a grown map, each with its reason.

#pragma once

#include "reconstruct/global/global_registration_state.h"

namespace velamap {

// Drops markers whose id is seen in two places with support for both.
void VoteOnIds(GlobalRegistration* global);

// Drops markers whose side differs from the others by far more than their print explains.
void DropWrongSizes(GlobalRegistration* global);

// Drops markers that the layout contradicts (layout_evidence.h). Needs `noise`. Returns whether
// there were any.
bool DropContradictions(const Layout& layout, GlobalRegistration* global);

// Leaves out frames whose corners scatter far more than in other frames, if other frames see their
// markers often enough. If the single markers of such a frame are sharp, it is counted as
// contradicting the map. Needs `noise`.
void LeaveOutBlurredFrames(GlobalRegistration* global);

// Leaves out all frames of a video but the max_num_frames that add most to the precision. Needs
// `noise`.
void LimitFrames(GlobalRegistration* global);

// Drops markers that too few frames see and frames that see too few markers, repeatedly, because
// each of them takes support from others.
void DropUnsupported(GlobalRegistration* global);

}  // namespace velamap
