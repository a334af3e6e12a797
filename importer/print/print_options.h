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
  kMarkers,  // stickers, wherever they go
  kGrid,     // stickers in rows and columns on a surface
  kSail,     // stickers on lines of a sail
  kHull,     // stickers on something rigid, without lines
  kBoard,    // a page of markers in rows and columns, for calibration
  kCharuco,  // a page with a chessboard that has markers in its white squares
};

struct PrintOptions {
  Arrangement arrangement = Arrangement::kMarkers;
  // Prints the markers of this layout, whose dictionary file is found, instead of an arrangement.
  std::optional<Layout> layout;
  std::string layout_path;                // where it was read
  std::string dictionary;                 // name or file; empty: DICT_4X4_250
  std::optional<double> marker_length_m;  // outer edge of the black square
  int border_bits = 1;
  int num_markers = 0;  // kMarkers
  int first_id = 0;
  std::vector<int> ids;  // prints only these; empty: all
  GridPlacementOptions grid;
  SailPlacementOptions sail;
  PrintSheetOptions sheet;
  CodeSearchOptions codes;
  std::uint32_t seed = 0;

  void Check() const;  // throws InputError that names the option
};

// The options that belong to no other group.
OptionGroup DescribeOptions(PrintOptions* options);

// Whether it is one page with all markers.
bool IsBoard(Arrangement arrangement);

constexpr char kDefaultDictionary[] = "DICT_4X4_250";

}  // namespace velamap
