#include "exporters/compare/section_comparison.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/compare/comparison.h"
#include "tests/exporters/compare/example_comparison.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;

SectionComparison Compare(const MarkerShape& shape, const MarkerShape& reference) {
  const Alignment alignment = AlignShapes(shape, reference, BoatLayout(), {});
  return CompareSections(WithSigmas(shape), WithSigmas(reference), alignment, BoatLayout(), "");
}

const SectionDifference& Find(const SectionComparison& comparison, const std::string& section,
                              const std::string& number) {
  const auto it =
      std::find_if(comparison.differences.begin(), comparison.differences.end(),
                   [&](const auto& d) { return d.section == section && d.number == number; });
  if (it == comparison.differences.end()) throw std::runtime_error("no " + section + number);
  return *it;
}

// Multiplies the depths of a line's markers above its chord.
MarkerShape WithMoreCamber(double factor, const std::vector<int>& ids, MarkerShape shape) {
  const Eigen::Vector3d first = *FindWholeMarker(shape, ids.front())->x_in_shape_m[0];
  const Eigen::Vector3d chord = *FindWholeMarker(shape, ids.back())->x_in_shape_m[0] - first;
  const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(chord).normalized();
  for (const int id : ids) {
    const double depth_m = across.dot(*FindWholeMarker(shape, id)->x_in_shape_m[0] - first);
    shape = Shifted({id}, (factor - 1) * depth_m * across, shape);
  }
  return shape;
}

TEST(ComparisonSections, AShapeMovedRigidlyHasTheSameSections) {
  const SectionComparison comparison =
      Compare(Moved(FarPose(), BoatShape(0.001)), BoatShape(0.001));
  EXPECT_EQ(comparison.differences.size(), 5u * 6);
  EXPECT_THAT(comparison.frame_name, HasSubstr("reference part hull"));
  for (const SectionDifference& d : comparison.differences) {
    EXPECT_NEAR(d.Difference(), 0, 1e-6) << d.section << " " << d.number;
    ASSERT_TRUE(d.sigma.has_value()) << d.section << " " << d.number;
    // The lowest section's twist is 0 by definition.
    const bool is_defined = d.section == "h1" && d.number == "twist_deg";
    EXPECT_EQ(*d.sigma > 0, !is_defined) << d.section << " " << d.number;
    EXPECT_FALSE(d.IsSignificant());
  }
}

TEST(ComparisonSections, MoreCamberInOneLineShowsThereAndOnlyThere) {
  const MarkerShape reference = BoatShape(0.001);
  const MarkerShape fuller = WithMoreCamber(1.2, {31, 32, 33, 34, 35, 36}, reference);
  const SectionComparison comparison = Compare(fuller, reference);
  const SectionDifference& camber = Find(comparison, "h3", "camber_percent");
  EXPECT_NEAR(camber.value / camber.reference, 1.2, 0.02);
  EXPECT_TRUE(camber.IsSignificant());
  EXPECT_GT(*camber.significance, 2);
  EXPECT_NEAR(Find(comparison, "h3", "twist_deg").Difference(), 0, 1e-3);
  EXPECT_FALSE(Find(comparison, "h2", "camber_percent").IsSignificant());
}

TEST(ComparisonSections, EndsThatOneLacksAreLeftOutOfBoth) {
  const MarkerShape whole = BoatShape(0.001);
  const SectionComparison comparison = Compare(Without({31}, whole), whole);
  EXPECT_NEAR(Find(comparison, "h3", "camber_percent").Difference(), 0, 1e-6);
  EXPECT_NEAR(Find(comparison, "h3", "chord_mm").Difference(), 0, 1e-6);
  EXPECT_THAT(comparison.notes, testing::Contains(HasSubstr(
                                    "h3: compared over the markers of both, 1 marker missing at "
                                    "the luff")));
}

TEST(ComparisonSections, ChordsOverDifferentMarkersAreNotCompared) {
  const MarkerShape whole = BoatShape(0.001);
  // Both have four markers of h1, but only 13 and 14 in common.
  const SectionComparison comparison = Compare(Without({15, 16}, whole), Without({11, 12}, whole));
  EXPECT_EQ(comparison.of_shape.sections.size(), 5u);
  EXPECT_EQ(comparison.of_reference.sections.size(), 5u);
  EXPECT_TRUE(std::none_of(comparison.differences.begin(), comparison.differences.end(),
                           [](const auto& d) { return d.section == "h1"; }));
  EXPECT_THAT(comparison.notes, testing::Contains(HasSubstr("sail h1: not compared")));
  EXPECT_THAT(comparison.notes, testing::Not(testing::Contains(HasSubstr("h1: compared over"))));
  // Twist counts from h2, which is whole in both.
  EXPECT_EQ(comparison.of_shape.rigs.at(0).reference_section, "h2");
  EXPECT_EQ(comparison.of_reference.rigs.at(0).reference_section, "h2");
  EXPECT_EQ(comparison.differences.size(), 4u * 6);
}

// The leech marker of the lowest line is missing in one of them only.
TEST(ComparisonSections, TwistCountsFromTheSameSectionInBoth) {
  const MarkerShape whole = BoatShape(0.001);
  const SectionComparison all = Compare(whole, whole);
  const double h2_deg = Find(all, "h2", "twist_deg").value;
  for (const SectionComparison& comparison :
       {Compare(Without({16}, whole), whole), Compare(whole, Without({16}, whole))}) {
    EXPECT_EQ(comparison.of_shape.rigs.at(0).reference_section, "h2");
    EXPECT_EQ(comparison.of_reference.rigs.at(0).reference_section, "h2");
    EXPECT_EQ(comparison.differences.size(), 5u * 6);
    const SectionDifference& twist = Find(comparison, "h5", "twist_deg");
    EXPECT_NEAR(twist.Difference(), 0, 1e-6);
    EXPECT_NEAR(twist.value, Find(all, "h5", "twist_deg").value - h2_deg, 0.02);
    EXPECT_THAT(comparison.notes,
                testing::Contains(HasSubstr("shape: twist, leech twist, bend and sag of sail "
                                            "refer to section h2")));
  }
}

TEST(ComparisonSections, WithoutAWholeSectionNoTwistIsCompared) {
  const MarkerShape whole = BoatShape(0.001);
  const SectionComparison comparison = Compare(Without({16, 26, 36, 46, 56}, whole), whole);
  EXPECT_EQ(comparison.differences.size(), 5u * 5);
  EXPECT_THAT(comparison.notes, testing::Contains(HasSubstr("reference: no twist, ")));
}

TEST(ComparisonSections, SigmaIsOfBothTogether) {
  const MarkerShape a = BoatShape(0.001), b = BoatShape(0.003);
  const double both = *Find(Compare(a, b), "h2", "camber_percent").sigma;
  const double of_a = *Find(Compare(a, a), "h2", "camber_percent").sigma / std::sqrt(2.0);
  const double of_b = *Find(Compare(b, b), "h2", "camber_percent").sigma / std::sqrt(2.0);
  EXPECT_NEAR(both, std::hypot(of_a, of_b), 0.02 * both);
}

TEST(ComparisonSections, WhatOneLacksIsSaid) {
  const SectionComparison comparison = Compare(BoatShape(), Without({11, 12, 13, 14}, BoatShape()));
  EXPECT_THAT(comparison.notes, ::testing::Contains(HasSubstr("reference: sail h1")));
  EXPECT_THAT(comparison.notes,
              ::testing::Contains(HasSubstr("twists of sail cannot be compared")));
  EXPECT_EQ(comparison.differences.size(), 4u * 5);
  EXPECT_FALSE(comparison.differences.front().sigma.has_value());
}

TEST(ComparisonSections, TwistsAreComparedPartByPart) {
  const Layout layout = WithJib(BoatLayout());
  MarkerShape without = WithJib(BoatShape());
  without.markers.erase(without.markers.begin(), without.markers.begin() + 6);  // h1 of the sail
  const MarkerShape shape = WithJib(BoatShape());
  const SectionComparison comparison = CompareSections(
      Exact(shape), Exact(without), AlignShapes(shape, without, layout, {}), layout, "");
  int num_of_sail = 0, num_of_jib = 0;
  for (const SectionDifference& d : comparison.differences) {
    if (d.number == "twist_deg") ++(d.part == "jib" ? num_of_jib : num_of_sail);
  }
  EXPECT_EQ(num_of_sail, 0);
  EXPECT_EQ(num_of_jib, 5);
  EXPECT_THAT(comparison.notes, ::testing::Contains(HasSubstr("twists of sail cannot be")));
  EXPECT_THAT(comparison.notes, ::testing::Not(::testing::Contains(HasSubstr("twists of jib"))));
}

// The lowest line of the jib is missing, which is noted only where the jib is compared.
TEST(ComparisonSections, OnlyThePartThatIsAskedForIsCompared) {
  const Layout layout = WithJib(BoatLayout());
  const UncertainShape reference = Exact(WithJib(BoatShape()));
  const UncertainShape shape = Exact(Without({211, 212, 213, 214, 215, 216}, WithJib(BoatShape())));
  const MeshDistance design(SailMesh());
  ComparisonOptions options;
  options.alignment.method = AlignmentMethod::kNone;
  EXPECT_THAT(velamap::Compare("trim", shape, reference, layout, options).sections.notes,
              ::testing::Contains(HasSubstr("jib h1")));
  options.part = "sail";
  for (const Comparison& comparison : {velamap::Compare("trim", shape, reference, layout, options),
                                       velamap::Compare("trim", shape, design, layout, options)}) {
    const SectionComparison& sections = comparison.sections;
    EXPECT_EQ(sections.of_shape.sections.size(), 5u);
    EXPECT_EQ(sections.of_reference.sections.size(), 5u);
    EXPECT_FALSE(sections.differences.empty());
    for (const SectionDifference& d : sections.differences) EXPECT_EQ(d.part, "sail");
    EXPECT_THAT(sections.notes, ::testing::Not(::testing::Contains(HasSubstr("jib"))));
  }
}

// The corners of the outer markers lie beyond the edge of the design, where it has no surface.
TEST(ComparisonSections, ASailOfTheDesignsShapeHasItsSectionsUpToTheEdge) {
  const MeshDistance design(SailMesh(0.0));
  ComparisonOptions options;
  options.alignment.method = AlignmentMethod::kNone;
  const UncertainShape sail = WithSigmas(BentBoatShape(0.0005));
  const SectionComparison sections =
      velamap::Compare("trim", sail, design, BoatLayout(), options).sections;
  ASSERT_EQ(sections.differences.size(), 5u * 6);
  for (const SectionDifference& d : sections.differences) {
    const double limit = d.number == "chord_mm" ? 0.1 : 0.02;  // mm, %, degrees
    EXPECT_NEAR(d.Difference(), 0.0, limit) << d.section << " " << d.number;
    EXPECT_FALSE(d.IsSignificant()) << d.section << " " << d.number;
  }
  // A design that is known less well is no reason for more significant numbers.
  options.surface_sigma_m = 0.001;
  const SectionComparison uncertain =
      velamap::Compare("trim", sail, design, BoatLayout(), options).sections;
  EXPECT_GT(*Find(uncertain, "h2", "camber_percent").sigma,
            1.5 * *Find(sections, "h2", "camber_percent").sigma);
}

// The design has no sigmas, by which its curves would be smoothed as those of the sail are.
TEST(ComparisonSections, LinesOfFourMarkersOnTheDesignDoNotDiffer) {
  const MeshDistance design(SailMesh());
  ComparisonOptions options;
  options.alignment.method = AlignmentMethod::kNone;
  const std::set<int> inner = {12, 15, 22, 25, 32, 35, 42, 45, 52, 55};
  for (const double sigma_m : {0.0005, 0.005}) {
    const UncertainShape sail = WithSigmas(Without(inner, BentBoatShape(sigma_m)));
    const SectionComparison sections =
        velamap::Compare("trim", sail, design, BoatLayout(), options).sections;
    ASSERT_EQ(sections.differences.size(), 5u * 6);
    for (const SectionDifference& d : sections.differences) {
      EXPECT_FALSE(d.IsSignificant()) << d.section << " " << d.number;
    }
    const SectionDifference& draft = Find(sections, "h2", "draft_position_percent");
    EXPECT_NEAR(draft.value, draft.reference, 0.2) << sigma_m;
  }
}

TEST(ComparisonSections, ALayoutWithoutLinesHasNone) {
  const MarkerShape boat = BoatShape();
  const SectionComparison comparison =
      CompareSections(WithSigmas(boat), WithSigmas(boat), Alignment(), Layout(), "");
  EXPECT_TRUE(comparison.differences.empty());
  EXPECT_FALSE(comparison.notes.empty());
}

}  // namespace
}  // namespace velamap
