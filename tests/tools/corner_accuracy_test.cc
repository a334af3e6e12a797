// Corners of rendered markers, measured against truth, SUBPIX and the Cramer-Rao bound; the full
// table is printed by the tool corner_accuracy.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/study/corner_study.h"

namespace velamap {

// How a failing test names its case.
void PrintTo(const CornerCase& one, std::ostream* out) {
  *out << one.side_px << " px, blur " << one.blur_px << ", noise " << one.noise << ", tilt "
       << one.min_tilt_deg << " to " << one.max_tilt_deg << ", JPEG " << one.jpeg_quality
       << ", bend " << one.bend_deg << " degrees";
}

namespace {

CornerCase Case(double side_px, double blur_px) {
  CornerCase one;
  one.side_px = side_px;
  one.blur_px = blur_px;
  one.min_markers = 48;
  return one;
}

CornerCase Tilted(double side_px) {
  CornerCase one = Case(side_px, 0.7);
  one.min_tilt_deg = 60;
  one.max_tilt_deg = 70;
  return one;
}

CornerCase Compressed(double side_px) {
  CornerCase one = Case(side_px, 0.7);
  one.jpeg_quality = 75;
  return one;
}

CornerCase Bent(double side_px, double bend_deg) {
  CornerCase one = Case(side_px, 0.7);
  one.bend_deg = bend_deg;
  return one;
}

class CornerAccuracyTest : public testing::TestWithParam<CornerCase> {};

TEST_P(CornerAccuracyTest, UnbiasedBetterThanSubpixAndHonest) {
  const CornerAccuracy found = MeasureCorners(GetParam());
  EXPECT_GE(found.num_markers, 48);
  EXPECT_LE(found.num_failed, found.num_markers / 50);
  const double max_bias_px = GetParam().side_px > 25 ? 0.02 : 0.05;
  EXPECT_LT(std::abs(found.side_bias_px), max_bias_px + 2 * found.side_bias_sigma_px);
  EXPECT_LE(found.std_px, found.subpix_std_px);
  EXPECT_LT(found.std_px, 6 * found.bound_px);
  EXPECT_GT(found.error_over_sigma, 0.8);
  EXPECT_LT(found.error_over_sigma, 1.4);
}

INSTANTIATE_TEST_SUITE_P(RenderedMarkers, CornerAccuracyTest,
                         testing::Values(Case(12, 0.7), Case(12, 1.5), Case(16, 0.4), Case(16, 1.0),
                                         Case(25, 1.5), Case(35, 0.7), Case(80, 0.4), Case(80, 1.5),
                                         Tilted(40), Tilted(65), Tilted(120), Compressed(16),
                                         Compressed(65), Bent(30, 5)));

}  // namespace
}  // namespace velamap
