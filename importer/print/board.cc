#include "importer/print/board.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr double kSquareOfMarker = 10.0 / 7.0;  // side of a chessboard square / side of a marker
constexpr double kLabel_mm = 8.0;               // height of the label below the board
constexpr double kArrow_mm = 6.0;

// A grid ends with its last marker, a chessboard with its last square.
Eigen::Vector2d SizeOf(const Board& board) {
  const auto extent_mm = [&](int count) {
    return board.kind == BoardKind::kCharuco ? count * board.spacing_mm
                                             : (count - 1) * board.spacing_mm + board.length_mm;
  };
  return {extent_mm(board.num_columns), extent_mm(board.num_rows)};
}

// The size of the board with the part of the outer markers' white margin that the border of the
// page does not provide. The outer squares of a chessboard provide the margin themselves.
Eigen::Vector2d SizeWithMargin(const Board& board, int num_cells) {
  const bool is_charuco = board.kind == BoardKind::kCharuco;
  const double white_mm =
      std::max(0.0, DefaultMargin(board.length_mm, num_cells) - board.frame.min_mm.x());
  return SizeOf(board) + Eigen::Vector2d::Constant(is_charuco ? 0.0 : 2 * white_mm);
}

double DefaultSpacing(BoardKind kind, double length_mm, int num_cells) {
  return kind == BoardKind::kCharuco ? kSquareOfMarker * length_mm
                                     : length_mm + DefaultMargin(length_mm, num_cells);
}

// The free area above the label.
Eigen::Vector2d Room(const PageFrame& frame) {
  return frame.FreeSize() - Eigen::Vector2d(0, kLabel_mm);
}

bool PrefersTurned(const Board& board, const Paper& paper) {
  const auto fit = [&](bool is_landscape) {
    const Eigen::Vector2d room = Room(MakePageFrame(paper, is_landscape));
    return std::min(room.x() / board.num_columns, room.y() / board.num_rows);
  };
  return fit(true) > fit(false);
}

bool Fits(const Board& board, int num_cells) {
  const Eigen::Vector2d left = Room(board.frame) - SizeWithMargin(board, num_cells);
  return left.minCoeff() > -1e-6;
}

// Sets the spacing, unless it is given, to the largest whole number of millimetres that fits, and
// the length from the spacing.
void ChooseSize(const std::optional<double>& spacing_m, int num_cells, Board* board) {
  const double length_per_spacing = 1 / DefaultSpacing(board->kind, 1.0, num_cells);
  board->spacing_mm = spacing_m ? 1000 * *spacing_m : std::floor(Room(board->frame).maxCoeff());
  while (true) {
    board->length_mm = board->spacing_mm * length_per_spacing;
    if (spacing_m || board->spacing_mm <= 1 || Fits(*board, num_cells)) return;
    board->spacing_mm -= 1;
  }
}

void CheckSize(const Paper& paper, int num_cells, const Board& board) {
  if (board.spacing_mm <= board.length_mm) {
    throw InputError(fmt::format(
        "{}: markers of {} do not fit at a spacing of {:.4g} m; give more than their side",
        OptionName(&GridPlacementOptions::spacing_m), LengthText(board.length_mm),
        board.spacing_mm / 1000));
  }
  if (Fits(board, num_cells)) return;
  const Eigen::Vector2d size = SizeWithMargin(board, num_cells), room = Room(board.frame);
  throw InputError(fmt::format(
      "{}: {} is too small for a board of {:.0f} x {:.0f} mm, because {:.0f} x {:.0f} mm are free; "
      "give larger paper, smaller markers (--marker_length) or fewer --Grid.columns and "
      "--Grid.rows",
      OptionName(&PrintSheetOptions::paper), paper.name, size.x(), size.y(), room.x(), room.y()));
}

void PlaceOnBoard(Board* board) {
  const double spacing = board->spacing_mm;
  const Eigen::Vector2d min_mm = board->frame.min_mm + 0.5 * (Room(board->frame) - SizeOf(*board));
  const bool is_charuco = board->kind == BoardKind::kCharuco;
  const double inset = is_charuco ? 0.5 * (spacing - board->length_mm) : 0.0;
  for (int row = 0; row < board->num_rows; ++row) {
    for (int column = 0; column < board->num_columns; ++column) {
      const Eigen::Vector2d place = min_mm + spacing * Eigen::Vector2d(column, row);
      // The top left square is black.
      if (is_charuco && row % 2 == column % 2) {
        board->square_min_mm.push_back(place);
      } else {
        board->marker_min_mm.push_back(place + Eigen::Vector2d::Constant(inset));
      }
    }
  }
  board->num_markers = static_cast<int>(board->marker_min_mm.size());
}

std::string Describe(const Board& board, const PrintedLook& look) {
  const std::string markers =
      fmt::format("{}, markers {} to {} of {}", look.dictionary.name, board.first_id,
                  board.first_id + board.num_markers - 1, LengthText(board.length_mm));
  return board.kind == BoardKind::kCharuco
             ? fmt::format("ChArUco, {} x {} squares of {}, {}", board.num_columns, board.num_rows,
                           LengthText(board.spacing_mm), markers)
             : fmt::format("{} x {} markers, {} between centres, {}", board.num_columns,
                           board.num_rows, LengthText(board.spacing_mm), markers);
}

}  // namespace

Board PlanBoard(BoardKind kind, const GridPlacementOptions& grid, const Paper& paper,
                std::optional<double> length_m, int num_cells, int first_id) {
  Board board;
  board.kind = kind;
  board.num_columns = grid.num_columns;
  board.num_rows = grid.num_rows;
  board.first_id = first_id;
  board.frame = MakePageFrame(paper, PrefersTurned(board, paper));
  if (length_m) {
    board.length_mm = 1000 * *length_m;
    board.spacing_mm =
        grid.spacing_m ? 1000 * *grid.spacing_m : DefaultSpacing(kind, board.length_mm, num_cells);
  } else {
    ChooseSize(grid.spacing_m, num_cells, &board);
  }
  CheckSize(paper, num_cells, board);
  PlaceOnBoard(&board);
  if (board.num_markers == 0) {
    throw InputError(
        OptionName(&GridPlacementOptions::num_rows) +
        ": a chessboard of one black square holds no marker; give more rows or columns");
  }
  return board;
}

Drawing DrawBoard(const Board& board, const PrintedLook& look, const SheetWords& words) {
  double first_mm = board.marker_min_mm.front().x();
  for (const auto* corners : {&board.marker_min_mm, &board.square_min_mm}) {
    for (const Eigen::Vector2d& min_mm : *corners) first_mm = std::min(first_mm, min_mm.x());
  }
  Drawing drawing = DrawPageFrame(board.frame, words, first_mm - board.frame.min_mm.x());
  for (int i = 0; i < board.num_markers; ++i) {
    drawing.areas.push_back(PrintedMarkerArea(look, board.first_id + i, board.length_mm,
                                              board.marker_min_mm[static_cast<std::size_t>(i)]));
  }
  FilledArea squares;
  for (const Eigen::Vector2d& min_mm : board.square_min_mm) {
    squares.outlines_mm.push_back(
        RectangleOutline(min_mm, min_mm + Eigen::Vector2d::Constant(board.spacing_mm)));
  }
  if (!squares.outlines_mm.empty()) drawing.areas.push_back(squares);
  const Eigen::Vector2d label(board.frame.min_mm.x(), board.frame.max_mm.y() - 1.0);
  drawing.areas.push_back(UpArrow(label + Eigen::Vector2d(2.5, 0), kArrow_mm));
  drawing.texts.push_back({"up   " + Describe(board, look), label + Eigen::Vector2d(6.0, 0), 3.0,
                           TextAnchor::kStart, false, kBlack, board.frame.FreeSize().x() - 6.0});
  return drawing;
}

}  // namespace velamap
