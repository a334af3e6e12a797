// Makes the files of a print: sheets of markers as PDF in true scale, single markers, the
// dictionary, a layout to start from, and drawings that show where each marker goes.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "importer/print/print_options.h"

namespace velamap {

// What the comments of a layout say about marker_length. Ink spreads over the edges of a square,
// and the corners that velamap finds are those of the drawing.
inline constexpr char kLengthFromScale[] =
    "If the printed scale is not as long as it says, change marker_length in the same proportion\n"
    "(do not measure the black squares: ink makes them larger).";

struct PrintReport {
  std::string dictionary;
  int num_codes = 0;
  std::optional<CodeSet> codes;  // if a custom dictionary was made
  int num_markers = 0;
  int num_sheets = 0;      // pages in true scale
  int num_drawings = 0;    // pages before these that show where the markers go
  double margin_mm = 0.0;  // of the first sticker; 0 for a board
  // The length that is drawn instead of marker_length, if the layout says that the printer changes
  // the size.
  std::optional<double> drawn_length_mm;
  std::vector<std::string> files;  // paths relative to the folder
};

// Makes the folder `output_path`:
//
//   sheets.pdf       drawings of where the markers go, then the sheets
//   layout.yml       a layout to start from; not if a layout is printed
//   dictionary.yml   a dictionary that is not one of OpenCV's; not if a layout is printed
//   placement.svg    where the markers go (grid, sail, hull)
//   board.svg        the board (board, charuco)
//   markers/         marker_0012.svg and .png, on request
//
// Replaces an earlier folder unless it was changed since. The same options give the same bytes,
// with the same fonts and version of cairo. Throws InputError as MakePrintPlan() does, if a marker
// or a board does not fit on the paper, and if the folder holds other files or cannot be written.
PrintReport PrintMarkers(const PrintOptions& options, const std::string& output_path);

}  // namespace velamap
