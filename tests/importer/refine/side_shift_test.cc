#include <algorithm>

#include <gtest/gtest.h>

#include "importer/pattern/pattern_fit.h"
#include "importer/refine/corner_refinement.h"
#include "tests/importer/refine/marker_grid.h"

namespace velamap {
namespace {

// Ink spread moves every side outwards by a known part of the side, the camera by a known part of
// the blur. With the cells of another marker, only the sides can be fitted.
TEST(RefineCorners, SidesAloneAreMovedBackByTheKnownShiftsOfEdges) {
  MarkerGridOptions options = Chequered(60, 1.0);
  MarkerGrid grid = MakeMarkerGrid(options);
  std::rotate(grid.cells.begin(), grid.cells.begin() + 1, grid.cells.end());
  ImageFormationParameters shifted;
  shifted.ink_spread_mm = 0.2;
  shifted.edge_shift_blurs = 0.1;
  shifted.outline_shift_blurs = 0.05;
  int num_compared = 0;
  for (std::size_t k = 0; k < grid.truth.size(); ++k) {
    if (FitPattern(grid.image, grid.starts[k], {grid.cells[k]}, ImageFormation(shifted))) continue;
    const auto apparent = RefineCorners(grid.image, grid.starts[k], {grid.cells[k]});
    const auto printed =
        RefineCorners(grid.image, grid.starts[k], {grid.cells[k]}, ImageFormation(shifted));
    ASSERT_TRUE(apparent && printed);
    const double side_px = QuadMeanSide(apparent->corners_px);
    const double shift_px = 0.002 * side_px + 0.15 * options.rendering.blur_sigma_px;
    EXPECT_NEAR(side_px - QuadMeanSide(printed->corners_px), 2 * shift_px, 0.2 * shift_px);
    EXPECT_GT(printed->sigma_px[0], 0.45 * shift_px);
    ++num_compared;
  }
  EXPECT_GT(num_compared, 3);
}

// Ink spreads by the same length on all paper, which is twice the share of a side of half the size.
TEST(RefineCorners, InkIsALengthOnThePaper) {
  MarkerGrid grid = MakeMarkerGrid(Chequered(60, 1.0));
  ImageFormationParameters some, twice_as_much;
  some.ink_spread_mm = 0.1;
  twice_as_much.ink_spread_mm = 0.2;
  for (const bool has_pattern : {true, false}) {
    int num_compared = 0;
    for (std::size_t k = 0; k < grid.truth.size(); ++k) {
      const auto refine = [&](double side_mm, const ImageFormationParameters& formation) {
        return RefineCorners(grid.image, grid.starts[k], {grid.cells[k], side_mm},
                             ImageFormation(formation));
      };
      const auto large = refine(100, some), small = refine(50, some);
      const auto inked = refine(100, twice_as_much);
      if (!large || !small || !inked) continue;
      EXPECT_LT(MaxCornerShift(small->corners_px, inked->corners_px), 1e-6);
      EXPECT_GT(QuadMeanSide(large->corners_px) - QuadMeanSide(small->corners_px), 0.02);
      ++num_compared;
    }
    EXPECT_GT(num_compared, 3) << has_pattern;
    std::rotate(grid.cells.begin(), grid.cells.begin() + 1, grid.cells.end());
  }
}

}  // namespace
}  // namespace velamap
