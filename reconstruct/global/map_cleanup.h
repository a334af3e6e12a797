// What is taken out of a grown map: markers and frames that do not belong in it, each with its
// reason.

#pragma once

#include "reconstruct/global/global_registration_state.h"

namespace velamap {

// Ids that stand at two places with support for both are nobody's.
void VoteOnIds(GlobalRegistration* global);

// Markers whose side differs from the others' by far more than print explains.
void DropWrongSizes(GlobalRegistration* global);

// Frames whose corners scatter far more than all others' go, where their markers are seen well
// enough without them. Needs `noise`.
void LeaveOutBlurredFrames(GlobalRegistration* global);

// Of a video, all but the max_num_frames that add most to the precision. Needs `noise`.
void LimitFrames(GlobalRegistration* global);

// Markers and frames that too little is left of, again and again, because each costs others
// support.
void DropRest(GlobalRegistration* global);

}  // namespace velamap
