// Plans where the markers are on the sheets of paper. All positions are in the page frame of
// drawing.h, mm.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/base/option.h"
#include "importer/print/paper.h"

namespace velamap {

struct PrintSheetOptions {
  Paper paper{"A4"};
  std::optional<double> margin_mm;  // white around the black square; not set: DefaultMargin()
  int markers_per_sheet = 0;        // 0: as many as fit
  bool write_svg = false;           // whether to write an SVG file for each marker
  bool write_png = false;           // whether to write a PNG file for each marker
  double png_dpi = 300.0;

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(PrintSheetOptions* options);

struct PrintedMarker {
  int marker_id = 0;
  double length_mm = 0.0;  // outer edge of the black square
  std::string place;       // where it goes, such as "sail h3, 2 of 8"; may be empty
};

// A sticker has the black square, the white margin around it, and a label below the margin. It is
// cut out along its outer edge.
struct Sticker {
  PrintedMarker marker;
  double margin_mm = 0.0;
  double label_mm = 0.0;                             // height of the label
  Eigen::Vector2d min_mm = Eigen::Vector2d::Zero();  // top left corner

  double Width() const { return marker.length_mm + 2 * margin_mm; }
  double Height() const { return Width() + label_mm; }
  Eigen::Vector2d SquareMin() const { return min_mm + Eigen::Vector2d::Constant(margin_mm); }
};

// A page and its free area for markers. Text is above this area, the scale below it.
struct PageFrame {
  double width_mm = 0.0;
  double height_mm = 0.0;
  Eigen::Vector2d min_mm, max_mm;  // of the free area

  Eigen::Vector2d FreeSize() const { return max_mm - min_mm; }
};

PageFrame MakePageFrame(const Paper& paper, bool is_landscape);

struct Sheet {
  PageFrame frame;
  std::vector<Sticker> stickers;
};

// The default white margin, the larger of one and a half cells, which the corner fit uses, and a
// quarter of the side, because a dark background that is closer shifts the corners. `num_cells`
// counts the cells along a side, with the border.
double DefaultMargin(double length_mm, int num_cells);

Sticker MakeSticker(const PrintedMarker& marker, int num_cells, const PrintSheetOptions& options);

// Fills sheets in the order of the markers. A new sheet begins where the size of the markers
// changes. The paper is upright unless more markers fit on it in the other orientation. Throws
// InputError, naming the option, for a marker that does not fit on the paper.
std::vector<Sheet> PlanSheets(const std::vector<PrintedMarker>& markers, int num_cells,
                              const PrintSheetOptions& options);

}  // namespace velamap
