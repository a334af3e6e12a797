// Draws sheets of markers.

#pragma once

#include <string>

#include "importer/layout/dictionary.h"
#include "importer/print/drawing.h"
#include "importer/print/sheet_plan.h"

namespace velamap {

// What the appearance of a marker depends on besides its id.
struct PrintedLook {
  Dictionary dictionary;
  int border_bits = 1;

  int NumCells() const { return CellsPerSide(dictionary, border_bits); }
};

// The text at the top of a sheet.
struct SheetWords {
  std::string title;     // such as "DICT_4X4_50, black squares of 100 mm"
  int sheet_number = 0;  // from 1
  int num_sheets = 0;
};

// The dark cells of a marker. `min_mm` is the top left corner of its black square.
FilledArea PrintedMarkerArea(const PrintedLook& look, int marker_id, double length_mm,
                             const Eigen::Vector2d& min_mm);

// Draws the text at the top of a page, and at the bottom a scale with the instruction to measure
// it. If the `free_left_mm` to the left of the markers are wide enough, a second, vertical scale is
// added there, because printers may stretch the two directions of the paper differently.
Drawing DrawPageFrame(const PageFrame& frame, const SheetWords& words, double free_left_mm);

Drawing DrawSheet(const Sheet& sheet, const PrintedLook& look, const SheetWords& words);

// The marker with its white margin only.
Drawing DrawSingleMarker(const PrintedMarker& marker, const PrintedLook& look, double margin_mm);

// "100 mm", "2.4 mm"
std::string LengthText(double length_mm);

// An arrow that points up from `foot_mm`.
FilledArea UpArrow(const Eigen::Vector2d& foot_mm, double height_mm);

}  // namespace velamap
