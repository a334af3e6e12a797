// Options of a print.

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "importer/base/option.h"
#include "importer/layout/code_search.h"
#include "importer/layout/layout.h"
#include "importer/print/placement.h"
#include "importer/print/sheet_plan.h"

namespace velamap {

enum class Arrangement {
  kMarkers,  // stickers without planned places
  kGrid,     // stickers in rows and columns on a surface
  kSail,     // stickers on the lines of a sail
  kHull,     // stickers on a rigid object, without lines
  kBoard,    // one page with markers in rows and columns, for calibration
  kCharuco,  // one page with a chessboard that has markers in its white squares, for calibration
};

struct PrintOptions {
  Arrangement arrangement = Arrangement::kMarkers;
  // If set, the markers of this layout are printed instead of an arrangement. A dictionary file is
  // named by a path that can be opened, as ReadLayout() returns it.
  std::optional<Layout> layout;
  std::string layout_path;                // the file from which it was read
  std::string dictionary;                 // name or file; empty: kDefaultDictionary
  std::optional<double> marker_length_m;  // outer edge of the black square
  int border_bits = 1;
  int num_markers = 0;  // for kMarkers
  int first_id = 0;
  std::vector<int> ids;  // only these are printed; empty: all
  GridPlacementOptions grid;
  SailPlacementOptions sail;
  PrintSheetOptions sheet;
  CodeSearchOptions codes;
  std::uint32_t seed = 0;

  void Check() const;  // throws InputError that names the option
};

// The options that are in no other group.
OptionGroup DescribeOptions(PrintOptions* options);

// Whether the arrangement is a calibration board, one page with all markers.
bool IsBoard(Arrangement arrangement);

constexpr char kDefaultDictionary[] = "DICT_4X4_250";

}  // namespace velamap
