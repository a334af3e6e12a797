// Where the markers lie on sheets of paper, in mm. Page frame as in drawing.h.

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
  std::optional<double> margin_mm;  // white around the black square; nothing: DefaultMargin()
  int markers_per_sheet = 0;        // 0: as many as there is room for
  bool write_svg = false;           // a file for each marker
  bool write_png = false;
  double png_dpi = 300.0;

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(PrintSheetOptions* options);

// A marker to be printed.
struct PrintedMarker {
  int marker_id = 0;
  double length_mm = 0.0;  // outer edge of the black square
  std::string place;       // where it goes, such as "sail h3, 2 of 8"; may be empty
};

// A sticker: the black square, the white margin around it, and the strip for words below. The words
// lie outside the margin. It is cut along its outer edge.
struct Sticker {
  PrintedMarker marker;
  double margin_mm = 0.0;
  double label_mm = 0.0;  // height of the strip
  Eigen::Vector2d min_mm = Eigen::Vector2d::Zero();

  double Width() const { return marker.length_mm + 2 * margin_mm; }
  double Height() const { return Width() + label_mm; }
  Eigen::Vector2d SquareMin() const { return min_mm + Eigen::Vector2d::Constant(margin_mm); }
};

// A page and its free area for markers, above and below which are words and the scale.
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

// The default white margin: the corner fit takes up to one and a half cells of it into account, and
// a dark background that is closer than a quarter of the side shifts the corners. `num_cells`
// counts the cells of a side, with the border.
double DefaultMargin(double length_mm, int num_cells);

Sticker MakeSticker(const PrintedMarker& marker, int num_cells, const PrintSheetOptions& options);

// Sheets in the order of the markers, as few as possible, upright unless more fit on turned paper;
// markers of different sizes get separate sheets. Throws InputError, naming the option, for a
// marker that does not fit on the paper.
std::vector<Sheet> PlanSheets(const std::vector<PrintedMarker>& markers, int num_cells,
                              const PrintSheetOptions& options);

}  // namespace velamap
