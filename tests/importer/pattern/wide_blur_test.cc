#include <cmath>

#include <gtest/gtest.h>

#include "importer/pattern/pattern_fit.h"
#include "tests/importer/refine/marker_grid.h"

namespace velamap {
namespace {

// Enlarged pictures and near markers out of focus. The blur is a third of a cell at most. A grid
// holds one marker of this size, so it takes many to tell the mean error.
TEST(FitPattern, AWideBlurOfLargeMarkersMovesNoSide) {
  for (const double blur_px : {3.0, 4.5, 5.5}) {
    double bias_px = 0.0, squares = 0.0, num = 0.0;
    for (int side_px = 109; side_px <= 132; ++side_px) {
      MarkerGridOptions options = Chequered(side_px, blur_px);
      options.dictionary = "DICT_4X4_50";
      options.max_tilt_deg = 20;
      options.rendering.quiet_zone_cells = 2.0;
      const MarkerGrid grid = MakeMarkerGrid(options);
      for (std::size_t k = 0; k < grid.truth.size(); ++k) {
        const auto fitted =
            FitPattern(grid.image, grid.starts[k], {grid.cells[k]}, ImageFormation());
        ASSERT_TRUE(fitted) << blur_px;
        bias_px += QuadMeanSide(fitted->corners_px) - QuadMeanSide(grid.truth[k]);
        for (std::size_t i = 0; i < kNumCorners; ++i) {
          squares += (fitted->corners_px[i] - grid.truth[k][i]).squaredNorm();
        }
        num += 1.0;
      }
    }
    EXPECT_LT(std::abs(bias_px / num), 0.025) << blur_px;
    EXPECT_LT(std::sqrt(squares / (kNumCorners * num)), 0.12) << blur_px;
  }
}

}  // namespace
}  // namespace velamap
