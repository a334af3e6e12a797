#include "reconstruct/sizes/part_sizes.h"

#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace velamap {
namespace {

using testing::HasSubstr;

constexpr double kPrintTolerance = 1e-3, kPrintScaleSigma = 1.1e-3;

// Markers of a part that are `ratio` times as large as printed; all errors are relative.
struct PartOfMarkers {
  std::string name;
  int num_markers = 0;
  double ratio = 1.0;
  double print_sigma = 0.0;
  double noise_sigma = 0.0;  // of the images, which is known
};

std::vector<MarkerSize> DrawSizes(const std::vector<PartOfMarkers>& parts, std::mt19937* random) {
  std::normal_distribution<double> normal;
  std::vector<MarkerSize> sizes;
  for (const PartOfMarkers& part : parts) {
    for (int i = 0; i < part.num_markers; ++i) {
      MarkerSize size;
      size.marker_id = static_cast<int>(sizes.size());
      size.part = part.name;
      size.num_sides = kNumCorners;
      size.ratio = part.ratio + part.print_sigma * normal(*random);
      size.ratio += part.noise_sigma * normal(*random);
      size.block_variance = part.noise_sigma * part.noise_sigma;
      size.by_factor = Eigen::VectorXd::Zero(1);
      sizes.push_back(size);
    }
  }
  return sizes;
}

double ShareOfDisagreements(const std::vector<PartOfMarkers>& parts) {
  constexpr int kNumDraws = 500;
  std::mt19937 random(5);
  int num = 0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    num += !JudgeParts(DrawSizes(parts, &random), kPrintTolerance, kPrintScaleSigma)
                .disagreement.empty();
  }
  return static_cast<double>(num) / kNumDraws;
}

// Their prints scatter four times as far as the tolerance says, which few markers hardly show.
TEST(JudgeParts, FewMarkersOfEqualPartsSeldomDisagreeByChance) {
  for (const auto& [num_parts, num_markers, max_share] :
       {std::tuple{2, 3, 0.06}, {2, 4, 0.02}, {3, 3, 0.08}, {6, 4, 0.02}, {4, 10, 0.01}}) {
    std::vector<PartOfMarkers> parts;
    for (int i = 0; i < num_parts; ++i) {
      parts.push_back({"part" + std::to_string(i), num_markers, 1.0, 0.002, 2e-4});
    }
    EXPECT_LE(ShareOfDisagreements(parts), max_share) << num_parts << " x " << num_markers;
  }
}

TEST(JudgeParts, WithoutTwoPartsOfThreeMarkersNothingIsCompared) {
  std::mt19937 random(3);
  for (const int num_of_first : {2, 5}) {
    const std::vector<PartOfMarkers> parts = {{"sail", num_of_first, 1.0, 5e-4, 3e-4},
                                              {"hull", 2, 1.02, 5e-4, 3e-4},
                                              {"boom", 1, 0.98, 5e-4, 3e-4}};
    const PartsVerdict verdict =
        JudgeParts(DrawSizes(parts, &random), kPrintTolerance, kPrintScaleSigma);
    EXPECT_EQ(verdict.disagreement, "");
    EXPECT_EQ(verdict.scale_sigma, 0.0);
  }
}

TEST(JudgeParts, APartThatIsHardlyKnownHidesNothing) {
  const std::vector<PartOfMarkers> two = {{"sail", 100, 1.003, 5e-4, 3e-4},
                                          {"hull", 60, 1.0, 5e-4, 3e-4}};
  std::mt19937 random(7);
  const PartsVerdict of_two =
      JudgeParts(DrawSizes(two, &random), kPrintTolerance, kPrintScaleSigma);
  EXPECT_THAT(of_two.disagreement, HasSubstr("sail and hull disagree by 0.30 +- 0.01 %"));
  // The scatter of two values, as wide as they may have hidden it.
  EXPECT_NEAR(of_two.scale_sigma, 1.84 * 0.003 / std::sqrt(2.0), 5e-4);
  for (const double sigma : {0.005, 0.01, 0.02}) {
    std::vector<PartOfMarkers> three = two;
    three.push_back({"boom", 3, 1.0015, 5e-4, sigma});
    const PartsVerdict of_three =
        JudgeParts(DrawSizes(three, &random), kPrintTolerance, kPrintScaleSigma);
    EXPECT_THAT(of_three.disagreement, HasSubstr("sail and the other parts disagree")) << sigma;
    EXPECT_GT(of_three.scale_sigma, 0.7 * of_two.scale_sigma) << sigma;
    EXPECT_LT(of_three.scale_sigma, 1.2 * of_two.scale_sigma) << sigma;
  }
}

// The corners of slanted markers on dark topsides are not shifted as those on white cloth.
TEST(JudgeParts, TheInsetOfCornersMayDifferBetweenParts) {
  std::mt19937 random(9);
  std::vector<MarkerSize> sizes =
      DrawSizes({{"sail", 100, 1.003, 5e-4, 3e-4}, {"hull", 8, 1.0, 5e-4, 3e-4}}, &random);
  for (const auto& [inset_sigma, agrees] : {std::pair{0.0, false}, {3e-4, false}, {2e-3, true}}) {
    for (MarkerSize& size : sizes) size.by_factor[0] = inset_sigma;
    const PartsVerdict verdict = JudgeParts(sizes, kPrintTolerance, kPrintScaleSigma);
    EXPECT_EQ(verdict.disagreement.empty(), agrees) << inset_sigma;
  }
}

}  // namespace
}  // namespace velamap
