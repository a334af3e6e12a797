// Plan of a print before anything is drawn: markers, dictionary, places and layout.

#pragma once

#include <optional>
#include <vector>

#include "importer/layout/code_search.h"
#include "importer/layout/layout.h"
#include "importer/print/board.h"
#include "importer/print/placement_drawing.h"
#include "importer/print/print_options.h"
#include "importer/print/sheet_drawing.h"
#include "importer/print/sheet_plan.h"

namespace velamap {

struct PrintPlan {
  PrintedLook look;
  std::optional<CodeSet> codes;        // of a dictionary that was made
  std::vector<PrintedMarker> markers;  // one sticker each; empty for a board
  PlacementPlan places;
  std::optional<Board> board;
  Layout layout;  // names the dictionary's file dictionary.yml where it is none of OpenCV's
};

// Throws InputError, naming the option, for options that contradict each other, more ids than
// codes, an id that is not there, and where the planners do.
PrintPlan MakePrintPlan(const PrintOptions& options);

constexpr char kDictionaryFile[] = "dictionary.yml";

}  // namespace velamap
