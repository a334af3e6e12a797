#include "reconstruct/solve/gram_matrix.h"

#include <algorithm>
#include <vector>

#include "importer/base/error.h"

namespace velamap {
namespace {

// A tile of the sum has kTileRows rows, in groups of four, and kTileCols columns: as many groups as
// an AVX2 processor has registers for. Its two panels of the rows stay in the first cache.
constexpr Eigen::Index kLaneCount = 4, kTileRows = 12, kTileCols = 4, kMaxNumSummands = 256;

// Columns of `rows` from `begin` on, kTileRows at a time one after another, zero beyond the last.
void PackPanels(const RowMajorMatrix& rows, Eigen::Index begin, Eigen::Index count,
                std::vector<double>* panels) {
  const Eigen::Index num_panels = (rows.cols() + kTileRows - 1) / kTileRows;
  panels->assign(static_cast<std::size_t>(num_panels * kTileRows * count), 0.0);
  double* out = panels->data();
  for (Eigen::Index panel = 0; panel < num_panels; ++panel) {
    const Eigen::Index first = panel * kTileRows, width = std::min(kTileRows, rows.cols() - first);
    for (Eigen::Index k = 0; k < count; ++k, out += kTileRows) {
      std::copy_n(rows.data() + (begin + k) * rows.cols() + first, width, out);
    }
  }
}

VELAMAP_WITH_AVX2 void SubtractPanels(const double* panels, Eigen::Index count, Eigen::Index size,
                                      double* sum) {
  double tile[kTileCols * kTileRows];
  for (Eigen::Index row = 0; row < size; row += kTileRows) {
    const double* row_panel = panels + row * count;
    const bool is_whole = row + kTileRows <= size;
    for (Eigen::Index col = 0; col < std::min(size, row + kTileRows); col += kTileCols) {
      const double* col_panel = panels + col / kTileRows * kTileRows * count + col % kTileRows;
      double* out = sum + col * size + row;
      if (is_whole) {
        AddTile<kTileCols, kLaneCount, kTileRows / kLaneCount, -1>(
            col_panel, 1, kTileRows, row_panel, kTileRows, count, out, size);
        continue;
      }
      std::fill(tile, tile + kTileCols * kTileRows, 0.0);
      AddTile<kTileCols, kLaneCount, kTileRows / kLaneCount, -1>(col_panel, 1, kTileRows, row_panel,
                                                                 kTileRows, count, tile, kTileRows);
      for (Eigen::Index i = 0; i < std::min(kTileCols, size - col); ++i) {
        for (Eigen::Index k = 0; k < size - row; ++k) out[i * size + k] += tile[i * kTileRows + k];
      }
    }
  }
}

// Of row-major rows, `panel` of the columns from `begin` on: with all columns before it solved,
// takes their part off and solves these. `panel` is root(begin + c, k) at k * kTileRows + c.
VELAMAP_WITH_AVX2 void SolvePanel(const double* panel, Eigen::Index begin, Eigen::Index width,
                                  Eigen::Index num_rows, Eigen::Index num_columns, double* rows) {
  double* out = rows + begin;
  if (width == kTileRows) {
    AddTiles<kTileRows, -1, kTileCols>(rows, num_columns, 1, num_rows, panel, kTileRows, begin, out,
                                       num_columns);
  } else {
    for (Eigen::Index c = 0; c < width; ++c) {
      AddTiles<1, -1, kTileCols>(rows, num_columns, 1, num_rows, panel + c, kTileRows, begin,
                                 out + c, num_columns);
    }
  }
  const double* triangle = panel + begin * kTileRows;
  for (Eigen::Index row = 0; row < num_rows; ++row, out += num_columns) {
    for (Eigen::Index k = 0; k < width; ++k) {
      out[k] /= triangle[k * kTileRows + k];
      for (Eigen::Index c = k + 1; c < width; ++c) out[c] -= out[k] * triangle[k * kTileRows + c];
    }
  }
}

}  // namespace

void SubtractGramMatrix(const RowMajorMatrix& rows, Eigen::MatrixXd* sum) {
  VELAMAP_CHECK(sum->rows() == rows.cols() && sum->cols() == rows.cols());
  if (!HasAvx2()) {
    sum->selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose(), -1.0);
    return;
  }
  std::vector<double> panels;
  for (Eigen::Index begin = 0; begin < rows.rows(); begin += kMaxNumSummands) {
    const Eigen::Index count = std::min(kMaxNumSummands, rows.rows() - begin);
    PackPanels(rows, begin, count, &panels);
    SubtractPanels(panels.data(), count, rows.cols(), sum->data());
  }
}

void SolveTransposedOnTheRight(const Eigen::MatrixXd& root, RowMajorMatrix* rows) {
  VELAMAP_CHECK(root.rows() == rows->cols() && root.cols() == rows->cols());
  if (!HasAvx2()) {
    root.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(*rows);
    return;
  }
  std::vector<double> panel;
  for (Eigen::Index begin = 0; begin < root.rows(); begin += kTileRows) {
    const Eigen::Index width = std::min(kTileRows, root.rows() - begin);
    panel.assign(static_cast<std::size_t>((begin + width) * kTileRows), 0.0);
    for (Eigen::Index k = 0; k < begin + width; ++k) {
      for (Eigen::Index c = 0; c < width; ++c) panel[k * kTileRows + c] = root(begin + c, k);
    }
    SolvePanel(panel.data(), begin, width, rows->rows(), rows->cols(), rows->data());
  }
}

}  // namespace velamap
