#include "exporters/scale/print_spread.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>

namespace velamap {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Truth {
  double print_um = 0.0;
  double image_px = 0.0;
  double scale_error = 0.0;
};

// Markers of two printed sizes from near to far, with 0.05 % of noise on their sides.
std::vector<SpreadSample> Samples(const Truth& truth, std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 5e-4);
  std::vector<SpreadSample> samples;
  for (int i = 0; i < 60; ++i) {
    SpreadSample sample;
    sample.length_m = i % 2 == 0 ? 0.010 : 0.025;
    sample.side_px = sample.length_m * 1500 / (0.3 + 0.02 * (i / 2));
    sample.log_side_ratio = truth.scale_error + 2e-6 * truth.print_um / sample.length_m +
                            2 * truth.image_px / *sample.side_px + noise(random);
    samples.push_back(sample);
  }
  return samples;
}

void ExpectWithin3Sigma(const std::optional<UncertainValue>& estimate, double truth,
                        double max_sigma) {
  ASSERT_TRUE(estimate.has_value());
  EXPECT_LT(std::abs(estimate->value - truth), 3 * estimate->sigma);
  EXPECT_LT(estimate->sigma, max_sigma);
}

TEST(PrintSpread, PrintAndImageAreToldApart) {
  for (const Truth& truth : {Truth{12, -0.08, 0.002}, Truth{-5, 0.05, 0}, Truth{}}) {
    const PrintSpread spread = EstimateSpread(Samples(truth));
    ExpectWithin3Sigma(spread.print_um, truth.print_um, 3.0);
    ExpectWithin3Sigma(spread.image_px, truth.image_px, 0.02);
    EXPECT_EQ(spread.note, "print and image separated");
  }
}

TEST(PrintSpread, SigmasAreCalibrated) {
  int num_within = 0;
  constexpr int kNumRuns = 300;
  for (int run = 0; run < kNumRuns; ++run) {
    const PrintSpread spread = EstimateSpread(Samples({12, -0.08, 0.002}, 100 + run));
    if (std::abs(spread.print_um->value - 12) < spread.print_um->sigma) ++num_within;
  }
  EXPECT_NEAR(num_within / static_cast<double>(kNumRuns), 0.66, 0.08);
}

TEST(PrintSpread, AWrongMarkerChangesNothing) {
  std::vector<SpreadSample> samples = Samples({12, -0.08, 0.0});
  for (int i = 0; i < 6; ++i) samples[10 * i].log_side_ratio += 0.3;
  ExpectWithin3Sigma(EstimateSpread(samples).print_um, 12, 4.0);
}

TEST(PrintSpread, OnePrintedSizeDeterminesTheImageOnly) {
  std::vector<SpreadSample> samples;
  for (const SpreadSample& sample : Samples({12, -0.08, 0.0})) {
    if (sample.length_m == 0.010) samples.push_back(sample);
  }
  const PrintSpread spread = EstimateSpread(samples);
  EXPECT_FALSE(spread.print_um.has_value());
  ExpectWithin3Sigma(spread.image_px, -0.08, 0.05);
  EXPECT_THAT(spread.note, StartsWith("image only"));
}

TEST(PrintSpread, WithoutImagesThePrintOnly) {
  std::vector<SpreadSample> samples = Samples({12, 0.0, 0.0});
  for (SpreadSample& sample : samples) sample.side_px.reset();
  const PrintSpread spread = EstimateSpread(samples);
  ExpectWithin3Sigma(spread.print_um, 12, 3.0);
  EXPECT_FALSE(spread.image_px.has_value());
  EXPECT_THAT(spread.note, StartsWith("print only"));
}

TEST(PrintSpread, OneDistanceDoesNotTellThemApart) {
  std::vector<SpreadSample> samples = Samples({12, 0.0, 0.0});
  for (SpreadSample& sample : samples) sample.side_px = 3000 * sample.length_m;
  const PrintSpread spread = EstimateSpread(samples);
  EXPECT_FALSE(spread.print_um || spread.image_px);
  EXPECT_THAT(spread.note, StartsWith("not determined: the larger markers are also larger in the"));
  // 12 um are 0.036 px at 3 px a mm.
  EXPECT_THAT(spread.note, HasSubstr(" px in the image explain the sides equally well"));
}

TEST(PrintSpread, IsSaidNotToBeDetermined) {
  std::vector<SpreadSample> samples = Samples({});
  for (SpreadSample& sample : samples) {
    sample.length_m = 0.01;
    sample.side_px = 40.0;
  }
  EXPECT_EQ(EstimateSpread(samples).note,
            "not determined: all markers are of one size in the print and in the images");
  EXPECT_EQ(EstimateSpread({}).note, "not determined: 0 markers are too few");
  for (SpreadSample& sample : samples) sample.side_px.reset();
  EXPECT_THAT(EstimateSpread(samples).note, HasSubstr("no images (a model) are given"));
}

}  // namespace
}  // namespace velamap
