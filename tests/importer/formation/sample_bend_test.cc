#include "importer/formation/sample_bend.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "importer/formation/formation_estimation.h"
#include "importer/pattern/pattern_fit.h"
#include "tests/importer/refine/marker_grid.h"
#include "tests/support/render/bent_marker.h"

namespace velamap {
namespace {

struct BentSamples {
  std::vector<FormationSample> samples;
  std::vector<PatternBend> bends;

  explicit BentSamples(int count) {
    std::mt19937 random(11);
    for (int i = 0; i < count; ++i) {
      const BentMarker marker = RandomBentMarker(&random);
      const BentMarkerView view = RenderBentMarker(marker, 1.0, &random);
      samples.push_back({view.gray, view.corners_px, KnownMarker{marker.cells}});
      bends.push_back(view.bend);
    }
  }
};

TEST(SampleBend, IsShownByMarkersAroundACylinderOnly) {
  EXPECT_TRUE(ShowBend(BentSamples(12).samples, ImageFormation(), {}));
  MarkerGridOptions options;
  options.side_px = 60;
  options.rendering.noise_sigma = 2.0;
  const MarkerGrid grid = MakeMarkerGrid(options);
  std::vector<FormationSample> flat;
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    flat.push_back({grid.image, grid.starts[i], KnownMarker{grid.cells[i]}});
  }
  ASSERT_GT(flat.size(), 5u);
  EXPECT_FALSE(ShowBend(flat, ImageFormation(), {}));
}

// If the bend were taken for moved outlines, a fit that knows the bend would find the sides 0.2 px
// too long.
TEST(FormationEstimation, DoesNotTakeABendForMovedEdges) {
  const BentSamples bent(10);
  const FormationEstimate estimate = EstimateFormation(bent.samples, false);
  EXPECT_GE(estimate.num_samples, 8);
  const ImageFormation formation(estimate.parameters);
  double error_px = 0.0;
  for (std::size_t i = 0; i < bent.samples.size(); ++i) {
    const FormationSample& sample = bent.samples[i];
    KnownMarker marker = sample.marker;
    marker.lens_bend = bent.bends[i];
    const auto fit = FitPattern(sample.gray, sample.corners_px, marker, formation);
    ASSERT_TRUE(fit) << i;
    error_px += QuadMeanSide(fit->corners_px) - QuadMeanSide(sample.corners_px);
  }
  error_px /= static_cast<double>(bent.samples.size());
  EXPECT_LT(std::abs(error_px), 0.03);
  EXPECT_LT(std::abs(error_px), 4 * estimate.inset_sigma_px);
  RecordProperty("error_px", std::to_string(error_px));
}

}  // namespace
}  // namespace velamap
