#include "reconstruct/sizes/marker_sizes.h"

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/reconstruct/sizes/printed_scene.h"

namespace velamap {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

// A sail of 24 markers and a hull of 6.
SyntheticScene TwoParts() {
  SyntheticSceneOptions options;
  options.num_rows = 5;
  options.num_columns = 6;
  options.num_frames = 9;
  SyntheticScene scene = MakeSyntheticScene(options);
  LayoutPart sail, hull;
  sail.name = "sail";
  hull.name = "hull";
  for (int id = 0; id < 24; ++id) sail.marker_ids.push_back(id);
  for (int id = 24; id < 30; ++id) hull.marker_ids.push_back(id);
  scene.layout.parts = {sail, hull};
  return scene;
}

class PartSizes : public PrintedSceneTest {
 protected:
  PartSizes() { scene_ = TwoParts(); }

  // Prints the markers of a part with this factor.
  void Print(std::size_t part_idx, double factor) {
    for (const int id : scene_.layout.parts[part_idx].marker_ids) ResizeMarker(id, factor, &scene_);
  }
};

TEST_F(PartSizes, PartsThatAgreeAreNotMentioned) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    EXPECT_THAT(Adjust(seed).warnings, IsEmpty()) << seed;
  }
}

TEST_F(PartSizes, ThatDisagreeAreReportedInOneLine) {
  const double sigma_before = Adjust().uncertainty.relative_scale_sigma;
  Print(1, 1.005);
  const auto summary = Adjust();
  ASSERT_THAT(summary.warnings, SizeIs(1));
  EXPECT_THAT(summary.warnings[0], AllOf(HasSubstr("sail and hull disagree by 0."),
                                         HasSubstr("the markers of sail are smaller"),
                                         HasSubstr("measure a distance on one of them")));
  // One of them is right, so that the mean of both is half the difference off. Of two values, 1.84
  // times the standard error of their mean (half the difference) holds 68 % of the errors.
  const double sigma = summary.uncertainty.relative_scale_sigma;
  EXPECT_NEAR(sigma, std::hypot(sigma_before, 1.84 * 0.0025), 5e-4);
  double mean_error = 0.0;
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    Adjust(seed);
    mean_error += ScaleError() / 5;
  }
  EXPECT_NEAR(mean_error, -0.0025, 5e-4);
}

// However far they are apart. A cost that falls with the size of the model would shrink it.
TEST_F(PartSizes, TheSizeIsTheMeanOfTwoThatDisagree) {
  const SyntheticScene exact = scene_;
  std::mt19937 generator(5);
  std::normal_distribution<double> print_error(0.0, 0.01);
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    scene_ = exact;
    const double of_sail = print_error(generator), of_hull = print_error(generator);
    Print(0, 1.0 + of_sail);
    Print(1, 1.0 + of_hull);
    const double sigma = Adjust(seed).uncertainty.relative_scale_sigma;
    const double half = std::abs(of_sail - of_hull) / 2;
    EXPECT_NEAR(ScaleError(), -(of_sail + of_hull) / 2, 2e-3) << 2 * half;
    EXPECT_NEAR(sigma, 1.84 * half, 2e-3) << 2 * half;
  }
}

TEST_F(PartSizes, ThatDisagreeAreDecidedByADistance) {
  Print(0, 1.005);
  const double length_m = (scene_.x_in_world.at(0)[0] - scene_.x_in_world.at(29)[0]).norm();
  scene_.layout.distances = {{0, 0, 29, 0, length_m, 1e-4, true}};
  const auto summary = Adjust();
  ASSERT_THAT(summary.warnings, SizeIs(1));
  EXPECT_THAT(summary.warnings[0],
              AllOf(HasSubstr("disagree"), HasSubstr("the measured distances decide")));
  EXPECT_LT(std::abs(ScaleError()), 3 * summary.uncertainty.relative_scale_sigma);
  EXPECT_LT(summary.uncertainty.relative_scale_sigma, 5e-4);
}

TEST_F(PartSizes, ATrulyBadMarkerOfThemIsStillNamed) {
  Print(1, 1.005);
  ResizeMarker(26, 1.03, &scene_);
  ResizeMarker(3, 0.97, &scene_);
  const auto warnings = Adjust().warnings;
  EXPECT_THAT(warnings, SizeIs(3));
  EXPECT_THAT(warnings, Contains(AllOf(HasSubstr("marker 26 is"), HasSubstr("larger"),
                                       HasSubstr("of its part"), HasSubstr("and its print"))));
  EXPECT_THAT(warnings, Contains(AllOf(HasSubstr("marker 3 is"), HasSubstr("smaller"))));
  EXPECT_THAT(warnings, Contains(HasSubstr("sail and hull disagree")));
}

TEST_F(PartSizes, AMarkerWithOneCornerOffIsNoBadPrint) {
  PullCorner(7, 2, 0.06, &scene_);
  EXPECT_THAT(Adjust().warnings,
              ElementsAre(AllOf(HasSubstr("marker 7 is"), HasSubstr("covers or bends it"))));
}

// Two markers cannot tell whether they are bad prints or another part.
TEST_F(PartSizes, OfTwoMarkersAreNoneOfTheirOwn) {
  auto& sail = scene_.layout.parts[0].marker_ids;
  auto& hull = scene_.layout.parts[1].marker_ids;
  sail.insert(sail.end(), hull.begin() + 2, hull.end());
  hull.resize(2);
  Print(1, 1.03);
  const auto warnings = Adjust().warnings;
  EXPECT_THAT(warnings, SizeIs(2));
  EXPECT_THAT(warnings, Not(Contains(HasSubstr("disagree"))));
}

TEST_F(PartSizes, OfThreeThatDisagreeTheOddOneIsNamed) {
  LayoutPart boom;
  boom.name = "boom";
  auto& sail = scene_.layout.parts[0].marker_ids;
  boom.marker_ids.assign(sail.end() - 6, sail.end());
  sail.resize(18);
  scene_.layout.parts.push_back(boom);
  Print(2, 0.99);
  const auto summary = Adjust();
  ASSERT_THAT(summary.warnings, SizeIs(1));
  EXPECT_THAT(summary.warnings[0], HasSubstr("boom and the other parts disagree by 1."));
  EXPECT_GT(summary.uncertainty.relative_scale_sigma, 0.003);
}

// The dots of a printer move the edges of small and of large markers equally far.
class PrinterDots : public PrintedSceneTest {
 protected:
  std::vector<std::string> Warnings(double marker_length_m, std::uint32_t seed) {
    constexpr double kDots_m = 2e-5;
    SyntheticSceneOptions options;
    options.marker_length_m = marker_length_m;
    options.spacing_m = 2.5 * marker_length_m;
    scene_ = WithPrintErrors(MakeSyntheticScene(options), kDots_m / marker_length_m, 0.003, seed);
    return Adjust(seed).warnings;
  }
};

TEST_F(PrinterDots, MakeTheSidesOfSmallMarkersScatter) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    EXPECT_THAT(Warnings(0.0025, seed), IsEmpty()) << seed;
    EXPECT_THAT(Warnings(0.1, seed), IsEmpty()) << seed;
  }
}

TEST_F(PrinterDots, DoNotExplainTheSameScatterOfLargeMarkers) {
  scene_ = WithPrintErrors(MakeSyntheticScene({}), 0.008, 0.003, 1);
  EXPECT_THAT(Adjust().warnings, Contains(HasSubstr("the sides of the markers scatter by 0.")));
}

// What lies behind a margin, and how blurred a marker is, differ from marker to marker.
class OwnInsets : public PartSizes {
 protected:
  static constexpr double kSigmaPx = 0.03;

  OwnInsets() {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0.0, kSigmaPx);
    for (const auto& [marker_id, points] : scene_.x_in_world)
      insets_px_[marker_id] = normal(random);
  }

  std::vector<std::string> Warnings(double inset_sigma_px) {
    SyntheticScene noisy = scene_;
    AddInset([&](const MarkerDetection& marker) { return insets_px_.at(marker.marker_id); },
             &noisy);
    AddNoise({0.02, 0, 0, 200, 1}, &noisy);
    model_ = MakeSceneModel(noisy);
    MarkerAdjustmentOptions options;
    options.inset_sigma_px = inset_sigma_px;
    options.print_tolerance = 1e-4;
    return AdjustWithMarkers(options, noisy.layout, {}, &model_).warnings;
  }

  std::map<int, double> insets_px_;
};

TEST_F(OwnInsets, AreNoMisprints) {
  EXPECT_THAT(Warnings(0), Not(IsEmpty()));
  EXPECT_THAT(Warnings(kSigmaPx), IsEmpty());
}

TEST_F(OwnInsets, HideNoMisprint) {
  ResizeMarker(8, 1.04, &scene_);
  EXPECT_THAT(Warnings(kSigmaPx), ElementsAre(HasSubstr("marker 8 is")));
}

// Small markers are too small by the inset of all, large ones less so.
TEST_F(OwnInsets, OfAllMarkersAreNoDisagreementOfParts) {
  for (auto& [marker_id, inset_px] : insets_px_) inset_px = 2 * kSigmaPx;
  for (const int id : scene_.layout.parts[1].marker_ids) {
    scene_.layout.marker_lengths_m[id] = 0.03;
    ResizeMarker(id, 0.3, &scene_);
  }
  EXPECT_THAT(Warnings(0), Contains(HasSubstr("disagree")));
  EXPECT_THAT(Warnings(kSigmaPx), IsEmpty());
}

}  // namespace
}  // namespace velamap
