#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "importer/geometry/alignment.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

using testing::Contains;
using testing::HasSubstr;

// Sizes of few markers that disagree with each other.
class FewMarkers : public testing::Test {
 protected:
  void Place(int num_rows, int num_columns) {
    SyntheticSceneOptions options;
    options.num_rows = num_rows;
    options.num_columns = num_columns;
    options.num_frames = 9;
    options.video = false;
    scene_ = MakeSyntheticScene(options);
  }

  std::vector<int> MarkerIdsOfScene() const {
    std::vector<int> ids;
    for (const auto& [marker_id, corners] : scene_.x_in_world) ids.push_back(marker_id);
    return ids;
  }

  MarkerAdjustmentSummary Adjust(std::uint32_t seed) {
    SyntheticScene noisy = scene_;
    AddNoise({0.05, 0, 0, 200, seed}, &noisy);
    model_ = MakeSceneModel(noisy);
    return AdjustWithMarkers({}, noisy.layout, {}, &model_);
  }

  double ScaleError() const {
    std::vector<Eigen::Vector3d> x_in_world, x_in_truth;
    for (const auto& [point3D_id, point] : model_.points3D) {
      const CornerId id = CornerFromPoint3DId(point3D_id);
      x_in_world.push_back(point.x_in_world);
      x_in_truth.push_back(scene_.x_in_world.at(id.marker_id)[id.corner]);
    }
    return EstimateSim3(x_in_truth, x_in_world).scale - 1.0;
  }

  SyntheticScene scene_;
  Model model_;
};

// No median is near half of them. A model without any size would shrink without end.
TEST_F(FewMarkers, OfTwoSizesInEqualNumbersKeepTheMean) {
  for (const int num_columns : {2, 3, 4}) {
    for (const double difference : {0.003, 0.01}) {
      Place(2, num_columns);
      double sign = 1.0;
      for (const int id : MarkerIdsOfScene()) {
        ResizeMarker(id, 1.0 + sign * difference, &scene_);
        sign = -sign;
      }
      const auto summary = Adjust(3);
      EXPECT_LT(std::abs(ScaleError()), 2e-3) << num_columns << ' ' << difference;
      const double sigma = summary.uncertainty.relative_scale_sigma;
      EXPECT_GT(sigma, 0.8 * difference / std::sqrt(2.0 * num_columns));
      EXPECT_LT(sigma, 2 * difference);
      EXPECT_THAT(summary.warnings, Contains(HasSubstr("sides of the markers scatter by")));
    }
  }
}

TEST_F(FewMarkers, ThatArePrintedBadlyKeepASigmaThatHolds) {
  constexpr int kNumDraws = 12;
  std::mt19937 generator(100);
  for (const int num_columns : {2, 3}) {
    double squares = 0.0;
    for (std::uint32_t draw = 1; draw <= kNumDraws; ++draw) {
      Place(2, num_columns);
      std::normal_distribution<double> size(1.0, 0.005);
      for (const int id : MarkerIdsOfScene()) ResizeMarker(id, size(generator), &scene_);
      const auto summary = Adjust(draw);
      squares += std::pow(ScaleError() / summary.uncertainty.relative_scale_sigma, 2);
    }
    const double rms = std::sqrt(squares / kNumDraws);
    EXPECT_GT(rms, 0.5) << num_columns;
    EXPECT_LT(rms, 1.4) << num_columns;
  }
}

TEST_F(FewMarkers, NameTheOneThatContradictsTheOthers) {
  Place(2, 3);
  ResizeMarker(MarkerIdsOfScene()[2], 1.02, &scene_);
  const auto warnings = Adjust(1).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0],
              HasSubstr("marker " + std::to_string(MarkerIdsOfScene()[2]) + " is 2.0"));
  EXPECT_LT(std::abs(ScaleError()), 2e-3);
}

}  // namespace
}  // namespace velamap
