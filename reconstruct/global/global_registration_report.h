// A finished global registration as the Registration that the next stage reads.

#pragma once

#include "reconstruct/global/global_registration_state.h"

namespace velamap {

// Puts the origin at the camera of the central frame (by frame_idx) and scales to metres.
Registration MakeRegistration(int central_idx, GlobalRegistration global);

}  // namespace velamap
