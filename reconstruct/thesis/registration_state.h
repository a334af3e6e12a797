// The state of a registration by the thesis's method, and the steps that advance it
// (thesis 3.4, 3.5).

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "importer/layout/layout.h"
#include "reconstruct/registration/registration_options.h"
#include "reconstruct/thesis/frame_selection.h"

namespace velamap {

struct RegistrationState {
  const Layout& layout;
  RegistrationOptions options;                // skip and neighborhood may be adapted to the video
  const std::vector<FrameShape>& frames;      // in canonical order
  const std::vector<const Camera*>& cameras;  // by frame_idx
  std::vector<std::optional<FrameAlignment>> alignments;  // by frame_idx; none: not registered
  ShapePoints shape;                                      // mean over the registered frames

  int NumRegistered() const;
};

// For photographs: starts with the markers of the central frame and adds the images that share most
// markers with the shape, until no image can be aligned.
void GrowFromCentralFrame(int central_idx, RegistrationState* state);

// For videos: the thesis's search around the central frame. Adds a note if it finds fewer frames
// than requested.
void SearchInTimeOrder(int central_idx, RegistrationState* state, std::vector<std::string>* notes);

// Alternates between aligning every registered frame with the mean shape and averaging the shape. A
// frame that cannot be aligned any more is dropped.
void RefineShape(RegistrationState* state);

}  // namespace velamap
