// The state of a registration while it grows, and the steps that advance it (thesis 3.4, 3.5).

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
  const RegistrationOptions& options;
  const std::vector<FrameShape>& frames;                  // in canonical order
  const std::vector<const Camera*>& cameras;              // by frame_idx, as the next
  std::vector<std::optional<FrameAlignment>> alignments;  // with the shape
  ShapePoints shape;                                      // mean over the aligned frames

  FrameAlignmentOptions AlignmentOptions() const;
  int NumRegistered() const;
};

// Photographs: from the central frame's markers on, images that share most markers with the shape
// join it, until none can.
void GrowFromCentralFrame(int central_idx, RegistrationState* state);

// Video: the thesis's search around the central frame. A note is added where it finds fewer frames
// than asked for.
void SearchInTimeOrder(int central_idx, const FrameSearchOptions& search, RegistrationState* state,
                       std::vector<std::string>* notes);

// Alternates aligning every registered frame with the mean shape and averaging anew. A frame that
// no longer aligns is dropped.
void RefineShape(RegistrationState* state);

}  // namespace velamap
