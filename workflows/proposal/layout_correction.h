// Compares a layout with the places of the markers in a clip, and corrects it.

#pragma once

#include "importer/layout/layout.h"
#include "workflows/proposal/layout_proposal.h"

namespace velamap {

// The layout with the lengths and the order of markers that the clip shows. Markers that the layout
// does not name are added; what the clip does not show stays as it is. `given` has parts.
LayoutProposal CorrectLayout(const ClipMap& map, const Layout& given);

}  // namespace velamap
