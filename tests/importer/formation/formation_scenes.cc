#include "tests/importer/formation/formation_scenes.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "importer/refine/corner_refinement.h"

namespace velamap {

MarkerGridOptions DrawScene(std::mt19937* random) {
  const auto draw = [random](double min, double max) {
    return std::uniform_real_distribution<double>(min, max)(*random);
  };
  MarkerGridOptions options;
  options.dictionary = "DICT_4X4_50";
  options.side_px = draw(18, 60);
  options.camera = {CameraModel::kPinhole, 1400, 1000, {2000, 2000, 700, 500}};
  RenderOptions& rendering = options.rendering;
  rendering.black = draw(8, 25);
  rendering.white = draw(140, 215);
  rendering.background = draw(15, 150);
  rendering.quiet_zone_cells = draw(0.7, 1.4);
  rendering.blur_sigma_px = draw(0.5, 0.9);
  rendering.noise_sigma = 1.0;
  rendering.camera.gamma = draw(1.0, 2.6);
  rendering.camera.s_amplitude = draw(0.0, 0.06);
  rendering.camera.sharpening = draw(0.0, 0.7);
  rendering.camera.sharpening_radius_px = draw(0.8, 1.3);
  return options;
}

std::vector<FormationSample> Samples(const MarkerGrid& grid) {
  constexpr std::size_t kNumSamples = 16;
  std::vector<FormationSample> samples;
  for (std::size_t k = 0; k < std::min(kNumSamples, grid.starts.size()); ++k) {
    samples.push_back({grid.image, grid.starts[k], {grid.cells[k]}});
  }
  return samples;
}

double SideBias(const MarkerGrid& grid, const ImageFormation& formation, double side_mm) {
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < grid.truth.size(); ++k) {
    const auto refined =
        RefineCorners(grid.image, grid.starts[k], {grid.cells[k], side_mm}, formation);
    if (!refined) continue;
    sum += QuadMeanSide(refined->corners_px) - QuadMeanSide(grid.truth[k]);
    ++count;
  }
  EXPECT_GE(count, static_cast<int>(grid.truth.size()) * 9 / 10);
  return sum / count;
}

}  // namespace velamap
