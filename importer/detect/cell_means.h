// Mean of a value over the dark and over the light cells of a marker.

#pragma once

#include <cstdint>
#include <optional>

#include <opencv2/core.hpp>

namespace velamap {

struct CellMeans {
  double dark = 0.0;            // every marker has a dark border
  std::optional<double> light;  // nothing without light cells
};

// `cells` as in pattern_fit.h. `read(column, row)` gives the value of a cell and is called row by
// row.
template <typename Read>
CellMeans MeansOfCells(const cv::Mat& cells, const Read& read) {
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.cols; ++column) {
      const int is_light = cells.at<std::uint8_t>(row, column) != 0;
      sum[is_light] += read(column, row);
      ++count[is_light];
    }
  }
  CellMeans means{sum[0] / count[0], {}};
  if (count[1] > 0) means.light = sum[1] / count[1];
  return means;
}

}  // namespace velamap
