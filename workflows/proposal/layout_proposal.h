// A layout from the markers of a clip in space.

#pragma once

#include <string>
#include <vector>

#include "importer/layout/layout.h"
#include "workflows/proposal/clip_map.h"

namespace velamap {

struct LayoutProposal {
  Layout layout;
  // What was measured and what is not sure, one line each: the comments at the top of the file.
  std::vector<std::string> notes;
  // Where the given layout is wrong, one line each.
  std::vector<std::string> contradictions;
};

// Proposes parts, lines and lengths for a layout without parts. Uses only the dictionary and the
// lengths of `known`. A flat group that is tilted relative to another one of its body becomes a
// rigid face, a group of two or more rows a part with lines, and any other group a rigid part.
LayoutProposal ProposeLayout(const ClipMap& map, const Layout& known);

// Notes the ids that `layout` does not name and that have no place, by reason.
void NoteLeftOut(const ClipMap& map, const Layout& layout, std::vector<std::string>* notes);

// Corrects the lengths of the markers that contradict `layout`.
void CorrectLengths(const ClipMap& map, LayoutProposal* proposal);

}  // namespace velamap
