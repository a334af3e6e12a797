#include "importer/print/sheet_plan.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr double kPrinterBorder_mm = 8.0;  // printers cannot print closer to the edge of the paper
constexpr double kHeader_mm = 7.0;         // line of text at the top
constexpr double kFooter_mm = 18.0;        // scale and text at the bottom
constexpr double kGutter_mm = 6.0;         // between stickers, for the cut marks
constexpr double kLabelOfLength = 0.08;
constexpr double kMinLabel_mm = 4.0, kMaxLabel_mm = 8.0;

struct Grid {
  PageFrame frame;
  int num_columns = 0;
  int num_rows = 0;

  int Count() const { return num_columns * num_rows; }
};

int NumThatFit(double room_mm, double size_mm) {
  // The thousandth of a millimetre allows for rounding.
  return static_cast<int>(std::floor((room_mm + kGutter_mm + 1e-3) / (size_mm + kGutter_mm)));
}

Grid MakeGrid(const Paper& paper, bool is_landscape, const Sticker& sticker) {
  const PageFrame frame = MakePageFrame(paper, is_landscape);
  const Eigen::Vector2d room_mm = frame.FreeSize();
  return {frame, std::max(0, NumThatFit(room_mm.x(), sticker.Width())),
          std::max(0, NumThatFit(room_mm.y(), sticker.Height()))};
}

int NumOnSheet(const Grid& grid, const PrintSheetOptions& options) {
  const int limit = options.markers_per_sheet;
  return limit > 0 ? std::min(grid.Count(), limit) : grid.Count();
}

[[noreturn]] void ThrowTooSmall(const Sticker& sticker, const PrintSheetOptions& options) {
  const Eigen::Vector2d room_mm = MakePageFrame(options.paper, false).FreeSize();
  throw InputError(fmt::format(
      "{}: {} is too small for marker {}, which takes {:.0f} x {:.0f} mm with its margin and "
      "label, while {:.0f} x {:.0f} mm are free; give larger paper, smaller markers "
      "(--marker_length, or marker_length of the layout) or a smaller {}",
      OptionName(&PrintSheetOptions::paper), options.paper.name, sticker.marker.marker_id,
      sticker.Width(), sticker.Height(), std::max(0.0, room_mm.x()), std::max(0.0, room_mm.y()),
      OptionName(&PrintSheetOptions::margin_mm)));
}

Grid ChooseGrid(const Sticker& sticker, const PrintSheetOptions& options) {
  const Grid upright = MakeGrid(options.paper, false, sticker);
  const Grid turned = MakeGrid(options.paper, true, sticker);
  const Grid& grid = NumOnSheet(turned, options) > NumOnSheet(upright, options) ? turned : upright;
  if (grid.Count() == 0) ThrowTooSmall(sticker, options);
  return grid;
}

// Places `count` stickers, starting with `first`, row by row in the middle of the free area.
Sheet FillSheet(const Grid& grid, const std::vector<Sticker>& stickers, std::size_t first,
                std::size_t count) {
  Sheet sheet{grid.frame, {}};
  const auto columns = std::min<std::size_t>(static_cast<std::size_t>(grid.num_columns), count);
  const std::size_t rows = (count + columns - 1) / columns;
  const Eigen::Vector2d size_mm(stickers[first].Width(), stickers[first].Height());
  const Eigen::Vector2d pitch_mm = size_mm + Eigen::Vector2d::Constant(kGutter_mm);
  const Eigen::Vector2d block_mm =
      pitch_mm.cwiseProduct(Eigen::Vector2d(double(columns), double(rows))) -
      Eigen::Vector2d::Constant(kGutter_mm);
  const Eigen::Vector2d min_mm = grid.frame.min_mm + 0.5 * (grid.frame.FreeSize() - block_mm);
  for (std::size_t i = 0; i < count; ++i) {
    Sticker sticker = stickers[first + i];
    sticker.min_mm =
        min_mm + pitch_mm.cwiseProduct(Eigen::Vector2d(double(i % columns), double(i / columns)));
    sheet.stickers.push_back(sticker);
  }
  return sheet;
}

void AddSheets(const std::vector<Sticker>& stickers, const PrintSheetOptions& options,
               std::vector<Sheet>* sheets) {
  const Grid grid = ChooseGrid(stickers.front(), options);
  const auto per_sheet = static_cast<std::size_t>(NumOnSheet(grid, options));
  for (std::size_t first = 0; first < stickers.size(); first += per_sheet) {
    sheets->push_back(
        FillSheet(grid, stickers, first, std::min(per_sheet, stickers.size() - first)));
  }
}

}  // namespace

void PrintSheetOptions::Check() const { CheckRanges(*this); }

OptionGroup DescribeOptions(PrintSheetOptions* options) {
  const auto set_paper = [options](const std::string& text, const std::string& option) {
    options->paper = ParsePaper(text, option);
  };
  return {
      "Sheets",
      {Common(
           {"Sheet.paper", ParsedValue{&options->paper, options->paper.name, set_paper},
            "A4|A3|Letter|WIDTHxHEIGHT in mm",
            "paper size; also A0 to A6, Legal, Tabloid, or width x height in mm such as 330x480"}),
       {"Sheet.margin", &options->margin_mm, "mm",
        "width of the white margin around the black square; left out: a quarter of the "
        "square's side, and at least 1.5 cells",
        FromTo(0, 500)},
       {"Sheet.markers_per_sheet", &options->markers_per_sheet, "count",
        "maximum number of markers on a sheet; 0: as many as there is room for", AtLeast(0)},
       {"Sheet.svg", &options->write_svg, "0|1", "also write every marker as an SVG file"},
       {"Sheet.png", &options->write_png, "0|1", "also write every marker as a PNG file"},
       {"Sheet.png_resolution", &options->png_dpi, "dpi",
        "minimum resolution of the PNG files; a cell is a whole number of pixels",
        FromTo(10, 10000)}}};
}

PageFrame MakePageFrame(const Paper& paper, bool is_landscape) {
  PageFrame frame;
  frame.width_mm = is_landscape ? paper.height_mm : paper.width_mm;
  frame.height_mm = is_landscape ? paper.width_mm : paper.height_mm;
  frame.min_mm = {kPrinterBorder_mm, kPrinterBorder_mm + kHeader_mm};
  frame.max_mm = {frame.width_mm - kPrinterBorder_mm,
                  frame.height_mm - kPrinterBorder_mm - kFooter_mm};
  return frame;
}

double DefaultMargin(double length_mm, int num_cells) {
  constexpr double kOfLength = 0.25, kCells = 1.5;
  return std::max(kOfLength * length_mm, kCells * length_mm / num_cells);
}

Sticker MakeSticker(const PrintedMarker& marker, int num_cells, const PrintSheetOptions& options) {
  Sticker sticker;
  sticker.marker = marker;
  sticker.margin_mm = options.margin_mm.value_or(DefaultMargin(marker.length_mm, num_cells));
  sticker.label_mm = std::clamp(kLabelOfLength * marker.length_mm, kMinLabel_mm, kMaxLabel_mm);
  return sticker;
}

std::vector<Sheet> PlanSheets(const std::vector<PrintedMarker>& markers, int num_cells,
                              const PrintSheetOptions& options) {
  std::vector<Sheet> sheets;
  std::vector<Sticker> stickers;
  for (const PrintedMarker& marker : markers) {
    if (!stickers.empty() && stickers.back().marker.length_mm != marker.length_mm) {
      AddSheets(stickers, options, &sheets);
      stickers.clear();
    }
    stickers.push_back(MakeSticker(marker, num_cells, options));
  }
  if (!stickers.empty()) AddSheets(stickers, options, &sheets);
  return sheets;
}

}  // namespace velamap
