#include "importer/refine/read_again.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/importer/refine/marker_grid.h"

namespace velamap {
namespace {

constexpr int kBorderBits = 1;

TEST(ReadCells, FindsEveryMarkerInEveryTurn) {
  const Dictionary dictionary = LoadDictionary("DICT_4X4_50");
  for (int id = 0; id < NumMarkers(dictionary); ++id) {
    cv::Mat cells = MarkerCells(dictionary, id, kBorderBits);
    for (int num_turns = 0; num_turns < 4; ++num_turns) {
      const auto code = ReadCells(dictionary, cells, kBorderBits);
      ASSERT_TRUE(code) << id;
      EXPECT_EQ(code->marker_id, id);
      EXPECT_EQ(code->first_corner, num_turns) << id;  // the corners turn clockwise as well
      cv::rotate(cells, cells, cv::ROTATE_90_CLOCKWISE);
    }
    cells.at<std::uint8_t>(0, 2) = 255;
    EXPECT_FALSE(ReadCells(dictionary, cells, kBorderBits)) << "a hole in the border";
  }
}

// Codes of 3x3 cells that differ in one: whatever the search takes a marker for, the fit shows it.
TEST(RefineAndReadAgain, AMisreadCodeIsCorrected) {
  MarkerGridOptions options;
  options.dictionary = "THESIS_3X3_130";
  options.side_px = 18;
  options.max_tilt_deg = 40;
  options.rendering.blur_sigma_px = 0.9;
  options.rendering.noise_sigma = 2.0;
  const MarkerGrid grid = MakeMarkerGrid(options);
  const Dictionary dictionary = LoadDictionary(options.dictionary);
  int num_misread = 0, num_corrected = 0;
  for (std::size_t k = 0; k < grid.truth.size(); ++k) {
    const auto truth = ReadCells(dictionary, grid.cells[k], kBorderBits);
    ASSERT_TRUE(truth);
    MarkerQuad right{truth->marker_id, grid.starts[k]};
    EXPECT_EQ(RefineAndReadAgain(grid.image, right, dictionary, kBorderBits, ImageFormation())
                  .quad.marker_id,
              truth->marker_id);
    const std::size_t cell_idx = k % 9;
    cv::Mat cells = grid.cells[k].clone();
    std::uint8_t& cell = cells.at<std::uint8_t>(1 + static_cast<int>(cell_idx / 3),
                                                1 + static_cast<int>(cell_idx % 3));
    cell = cell == 0 ? 255 : 0;
    const auto misread = ReadCells(dictionary, cells, kBorderBits);
    if (!misread) continue;
    MarkerQuad quad{misread->marker_id, grid.starts[k]};
    std::rotate(quad.corners_px.begin(), quad.corners_px.begin() + misread->first_corner,
                quad.corners_px.end());
    const ReadMarker read =
        RefineAndReadAgain(grid.image, quad, dictionary, kBorderBits, ImageFormation());
    ++num_misread;
    if (read.quad.marker_id != truth->marker_id) continue;
    ++num_corrected;
    for (std::size_t c = 0; c < kNumCorners; ++c) {
      EXPECT_LT((read.refined->corners_px[c] - grid.truth[k][c]).norm(), 0.5);
    }
  }
  EXPECT_GT(num_misread, 20);
  EXPECT_GE(num_corrected, 0.95 * num_misread);
}

}  // namespace
}  // namespace velamap
