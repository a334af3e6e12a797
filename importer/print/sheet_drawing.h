// Draws sheets of markers.

#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "importer/layout/dictionary.h"
#include "importer/print/drawing.h"
#include "importer/print/sheet_plan.h"

namespace velamap {

struct PrintedLook {
  Dictionary dictionary;
  int border_bits = 1;
};

// What all sheets of a print have in common.
struct SheetWords {
  std::string title;     // such as "DICT_4X4_50, black squares of 100 mm"
  int sheet_number = 0;  // from 1
  int num_sheets = 0;
};

// The dark cells of a marker whose black square begins at `min_mm`.
FilledArea MarkerArea(const PrintedLook& look, int marker_id, double length_mm,
                      const Eigen::Vector2d& min_mm);

// Words at the top of a page, and the scale with what to do with it at the bottom. A second scale
// stands upright at the left edge of the free area where `free_left_mm` of it are enough.
Drawing DrawPageFrame(const PageFrame& frame, const SheetWords& words, double free_left_mm);

Drawing DrawSheet(const Sheet& sheet, const PrintedLook& look, const SheetWords& words);

// The marker with its margin and nothing else.
Drawing DrawSingleMarker(const PrintedMarker& marker, const PrintedLook& look, double margin_mm);

// "100 mm", "2.4 mm"
std::string LengthText(double length_mm);

// An arrow that points up, its foot in the middle of the lower side of a box.
FilledArea UpArrow(const Eigen::Vector2d& foot_mm, double height_mm);

}  // namespace velamap
