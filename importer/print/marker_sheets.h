// Markers to print: sheets as PDF in true scale, single markers, the dictionary, a layout to start
// from, and drawings of where each marker goes.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "importer/print/print_options.h"

namespace velamap {

struct PrintReport {
  std::string dictionary;
  int num_codes = 0;
  std::optional<CodeSet> codes;  // of a dictionary that was made
  int num_markers = 0;
  int num_sheets = 0;              // in true scale
  int num_drawings = 0;            // pages before them that say where the markers go
  double margin_mm = 0.0;          // of the first sticker; zero for a board
  std::vector<std::string> files;  // relative to the folder
};

// Makes the folder `output_path`:
//
//   sheets.pdf       where the markers go, then the sheets
//   layout.yml       to start from; not where a layout is printed
//   dictionary.yml   where the dictionary is none of OpenCV's; not where a layout is printed
//   placement.svg    where the markers go (grid, sail, hull)
//   board.svg        the board (board, charuco)
//   markers/         marker_0012.svg and .png, on request
//
// An earlier folder is replaced if nobody has changed it since. The same options give the same
// bytes, with the same fonts and cairo. Throws InputError as MakePrintPlan() does, if a marker or
// board does not fit on the paper, and if the folder holds anything else or cannot be written.
PrintReport PrintMarkers(const PrintOptions& options, const std::string& output_path);

}  // namespace velamap
