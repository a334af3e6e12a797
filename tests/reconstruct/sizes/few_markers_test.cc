#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/reconstruct/sizes/printed_scene.h"

namespace velamap {
namespace {

using testing::Contains;
using testing::HasSubstr;

// Sizes of few markers that disagree with each other.
class FewMarkers : public PrintedSceneTest {
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
