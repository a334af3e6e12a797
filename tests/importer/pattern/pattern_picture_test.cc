#include "importer/pattern/pattern_picture.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/importer/lane_derivatives.h"
#include "tests/importer/refine/marker_grid.h"

namespace velamap {
namespace {

// The share of a single corner is an approximation; all four together move the picture as it is.
TEST(PatternPicture, DerivativesAgreeWithDifferences) {
  using P = PatternParameters;
  const MarkerGrid grid = MakeMarkerGrid(Chequered(20, 0.7));
  PatternModel model;
  model.num_cells = grid.cells[0].rows;
  model.center_px = {300, 200};
  model.diagonal_px = 20 * std::sqrt(2.0);
  P::Vector parameters = P::Vector::Zero();
  parameters.head<8>() << 290, 190, 310, 190, 310, 210, 290, 210;
  parameters.segment<8>(P::kBlurU) << 0.8, 0.9, 40, 200, 0.05, -0.03, 0.9, 0.95;
  parameters.segment<4>(P::kMargin) << 0.7, 0.9, 1.1, 0.8;
  ImageFormationParameters camera;
  camera.gamma = 2.2;
  camera.s_amplitude = 0.03;
  camera.halo = 0.08;
  const ImageFormation formation(camera);
  model.formation = &formation;
  const GrayPatch patch = CutPatch(grid.image, cv::Rect({}, grid.image.size()), formation);
  model.scattered_light = patch.scattered_light;
  model.center_in_patch_px = model.center_px;
  FillLightness(patch, grid.cells[0], parameters, &model);
  const Floats x = {-10.6f, -3.2f, 4.7f, 10.3f, 9.8f, -9.1f, 0.3f, 2.6f};
  const Floats y = {0.4f, -9.8f, 5.1f, 10.9f, -10.7f, 9.7f, -0.2f, 7.4f};
  ASSERT_EQ(Sum(__builtin_convertvector(PatternPicture(model, parameters).Covers(x, y), Floats)),
            -kLanes);
  PatternPixels pixels;
  PatternPicture(model, parameters).At(x, y, &pixels);
  // Place of the whole marker, then all parameters but the corners.
  using Changes = Eigen::Matrix<double, P::kCount - 6, 1>;
  FloatsArray<P::kCount - 6> jacobian{};
  for (std::size_t i = 0; i < P::kCount; ++i) {
    jacobian[i < P::kBlurU ? i % 2 : i - 6] += pixels.jacobian[i];
  }
  const auto value = [&](const Changes& changes) {
    P::Vector changed = parameters;
    for (int i = 0; i < P::kBlurU; ++i) changed[i] += changes[i % 2];
    changed.tail<P::kCount - P::kBlurU>() += changes.tail<P::kCount - P::kBlurU>();
    PatternPixels modelled;
    PatternPicture(model, changed).At(x, y, &modelled);
    return modelled.gray;
  };
  ExpectDerivatives<Changes>(Changes::Zero(), Changes::Constant(0.01), jacobian, value, 0.02, 0.3);
}

TEST(ComputeCellWeights, StayInsideThePatternAndAddUpToOne) {
  constexpr int kNumCells = 6;
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  CellWeights weights;
  for (const double blur : {0.1, 0.5, 3.0, 100.0}) {
    ComputeCellWeights(Floats{-0.7f, 1.3f, 6.6f, 1e9f, -1e9f, 0.0f, 3.5f, 6.0f}, AllLanes(blur),
                       kNumCells, {0.4f, 1.2f, AllLanes(0.2)}, &weights);
    Floats sum{};
    for (int i = 0; i < weights.count; ++i) sum += weights.value[static_cast<std::size_t>(i)];
    for (int lane = 0; lane < kLanes; ++lane) EXPECT_NEAR(sum[lane], 1.0f, 1e-5f);
  }
  for (const float blur : {0.5f, infinity, nan}) {
    ComputeCellWeights(Floats{nan, infinity, -infinity, 0.0f, 2.0f, nan, nan, infinity},
                       Floats{0.3f, blur, blur, 0.3f, blur, blur, 0.3f, 0.3f}, kNumCells, {},
                       &weights);
    for (int lane = 0; lane < kLanes; ++lane) {
      EXPECT_GE(weights.first[lane], 0);
      EXPECT_LE(weights.first[lane] + weights.count, kNumCells + 2 * kRing);
    }
  }
}

TEST(PatternPicture, CoversTheMarkerAndMostOfTheQuietZone) {
  const ImageFormation formation;
  PatternModel model;
  model.formation = &formation;
  model.num_cells = 6;
  model.center_px = {300, 200};
  model.diagonal_px = 12 * std::sqrt(2.0);
  PatternParameters::Vector parameters = PatternParameters::Vector::Zero();
  parameters.head<8>() << 294, 194, 306, 194, 306, 206, 294, 206;
  const PatternPicture picture(model, parameters);
  const Ints covered = picture.Covers(Floats{0, -7.4f, -7.6f, 7.4f}, Floats{0, 7.4f, 0, 7.6f});
  EXPECT_TRUE(covered[0]);
  EXPECT_TRUE(covered[1]);
  EXPECT_FALSE(covered[2]);
  EXPECT_FALSE(covered[3]);
}

}  // namespace
}  // namespace velamap
