#include "importer/pattern/mismatched_cells.h"

#include <cstdint>

#include "importer/geometry/unit_square_map.h"
#include "importer/pattern/pattern_picture.h"

namespace velamap {

VELAMAP_CLONE_FOR_AVX2 std::vector<cv::Point> MismatchedCells(const PatternProblem& problem,
                                                              const PatternMinimum& minimum) {
  constexpr double kMismatch = 0.25;  // of the contrast
  const double limit_gray = kMismatch * ContrastOf(problem, minimum);
  const PatternParameters::Vector& parameters = minimum.parameters;
  const PatternPicture picture(problem.model, parameters);
  const UnitSquareMap map(CornersOf(parameters));
  const int n = problem.model.num_cells;
  std::vector<cv::Point> mismatched;
  PatternPixels modelled;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const double u = (column + 0.5) / n, v = (row + 0.5) / n;
      const Eigen::Vector2d x_px =
          map.ToImage(u, v) + 4 * u * (1 - u) * parameters.segment<2>(PatternParameters::kBendU) +
          4 * v * (1 - v) * parameters.segment<2>(PatternParameters::kBendV);
      const Eigen::Vector2d place = x_px - problem.model.center_px;
      picture.At(AllLanes(place.x()), AllLanes(place.y()), &modelled);
      const double excess_gray = InterpolatePatch(problem.patch, x_px) - modelled.gray[0];
      const bool is_light = problem.cells.at<std::uint8_t>(row, column) != 0;
      if ((is_light ? -excess_gray : excess_gray) > limit_gray) {
        mismatched.emplace_back(column, row);
      }
    }
  }
  return mismatched;
}

}  // namespace velamap
