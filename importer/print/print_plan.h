// Plans a print before anything is drawn: markers, dictionary, places and layout.

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
  std::optional<CodeSet> codes;        // if a custom dictionary is made
  std::vector<PrintedMarker> markers;  // one per sticker; empty for a board
  PlacementPlan places;
  std::optional<Board> board;
  Layout layout;  // its dictionary is an OpenCV name or kDictionaryFile
};

// Throws InputError, naming the option, for missing or contradictory options, for ids beyond the
// codes of the dictionary, for an id in `options.ids` that is not to be printed, and as
// LoadDictionary(), FindCodes(), PlanBoard(), PlaceOnSail() and PlaceOnGrid() do.
PrintPlan MakePrintPlan(const PrintOptions& options);

// The file name of a dictionary that is not one of OpenCV's.
constexpr char kDictionaryFile[] = "dictionary.yml";

}  // namespace velamap
