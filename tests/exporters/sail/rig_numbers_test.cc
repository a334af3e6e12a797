// Bend and sag of the luff, sheeting angle, girth and leech twist.

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/sail/section.h"
#include "importer/geometry/units.h"
#include "tests/exporters/sail/sail_shapes.h"

namespace velamap {
namespace {

using testing::ElementsAre;

constexpr double kHeight_m = 4.0, kBend_m = 0.06, kSag_m = 0.025;
constexpr double kBoom_deg = 9.0, kCenterline_deg = -3.0;  // against the lowest chord, to leeward

void AddPair(const std::string& part, int id, double leeward_deg, int leeward, Sail* sail) {
  const double angle = leeward * leeward_deg * kRadPerDeg;
  const Eigen::Vector3d aft(std::cos(angle), std::sin(angle), 0);
  LayoutPart pair;
  pair.name = part;
  for (const double distance_m : {0.2, 2.8}) {
    // Ids rise, as those of the markers of a shape do.
    sail->shape.markers.insert(
        sail->shape.markers.begin() + (id < 60 ? id - 51 : id - 59),
        UprightMarker(id, part, distance_m * aft - Eigen::Vector3d(0, 0, 0.3)));
    pair.marker_ids.insert(pair.marker_ids.begin(), id++);
  }
  sail->layout.parts.push_back(pair);
}

// Five lines whose luff bends forwards and sags to leeward as a parabola, over a boom and a centre
// line.
Sail BentSail(int leeward = 1) {
  std::vector<SailLine> lines;
  for (int i = 0; i < 5; ++i) {
    lines.push_back({kHeight_m * i / 4, 3.0 - 0.4 * i, 3.0 * i, CircularArc(0.1)});
  }
  Sail sail = MakeSailOfLines(lines, 9, leeward);
  for (ShapeMarker& marker : sail.shape.markers) {
    const double height_m = lines[static_cast<std::size_t>(marker.marker_id / 100 - 1)].height_m;
    const double share = 4 * height_m * (kHeight_m - height_m) / (kHeight_m * kHeight_m);
    for (auto& x : marker.x_in_shape_m) {
      *x += share * Eigen::Vector3d(-kBend_m, leeward * kSag_m, 0);
    }
  }
  AddPair("boom", 51, kBoom_deg, leeward, &sail);
  AddPair("centerline", 61, kCenterline_deg, leeward, &sail);
  return sail;
}

// The luff of a sail whose fore-and-aft direction is at this angle to the lowest chord.
void ExpectLuff(const RigNumbers& rig, double aft_deg) {
  const double c = std::cos(aft_deg * kRadPerDeg), s = std::sin(aft_deg * kRadPerDeg);
  ASSERT_TRUE(rig.luff_bend_m && rig.luff_sag_m);
  EXPECT_NEAR(rig.luff_bend_m->value, kBend_m * c - kSag_m * s, 1e-4);
  EXPECT_NEAR(rig.luff_sag_m->value, kSag_m * c + kBend_m * s, 1e-4);
}

TEST(RigNumbers, ABentLuffAndTheSheetingAngleAreThoseOfTheSail) {
  for (const int leeward : {1, -1}) {
    const SectionReport report = SectionsOf(BentSail(leeward));
    ASSERT_EQ(report.rigs.size(), 1u);
    const RigNumbers& rig = report.rigs[0];
    EXPECT_EQ(rig.part, "sail");
    EXPECT_EQ(rig.aft_reference, "centerline");
    EXPECT_THAT(rig.luff_marker_ids, ElementsAre(100, 200, 300, 400, 500));
    ExpectLuff(rig, kCenterline_deg);
    ASSERT_TRUE(rig.sheeting_angle_deg);
    EXPECT_NEAR(rig.sheeting_angle_deg->value, kBoom_deg - kCenterline_deg, 1e-6);
    EXPECT_FALSE(rig.luff_bend_m->sigma);
  }
}

TEST(RigNumbers, WithoutABoomAndACenterLineTheLowestChordStandsIn) {
  Sail sail = BentSail();
  RemoveMarker(51, &sail.shape);
  EXPECT_NEAR(SectionsOf(sail).rigs.at(0).sheeting_angle_deg->value, -kCenterline_deg, 1e-4);
  RemoveMarker(62, &sail.shape);
  const RigNumbers rig = SectionsOf(sail).rigs.at(0);
  EXPECT_EQ(rig.aft_reference, "lowest section");
  EXPECT_FALSE(rig.sheeting_angle_deg);
  ExpectLuff(rig, 0);
}

// Without its leech, the lowest chord points elsewhere.
TEST(RigNumbers, AChordThatLacksAnEndStandsForNothing) {
  constexpr double kTwist_deg = 3.0;  // of the second line
  Sail sail = BentSail();
  RemoveMarker(51, &sail.shape);  // one marker of the boom is no boom
  for (const int id : {106, 107, 108}) RemoveMarker(id, &sail.shape);
  RigNumbers rig = SectionsOf(sail).rigs.at(0);
  EXPECT_EQ(rig.reference_section, "h2");
  EXPECT_NEAR(rig.sheeting_angle_deg->value, kTwist_deg - kCenterline_deg, 1e-4);
  ExpectLuff(rig, kCenterline_deg);
  RemoveMarker(62, &sail.shape);  // the same of the centre line
  rig = SectionsOf(sail).rigs.at(0);
  EXPECT_EQ(rig.aft_reference, "section h2");
  ExpectLuff(rig, kTwist_deg);
  for (const int id : {208, 308, 408, 508}) RemoveMarker(id, &sail.shape);
  rig = SectionsOf(sail).rigs.at(0);
  EXPECT_EQ(rig.aft_reference, "none");
  EXPECT_EQ(rig.reference_section, "");
  EXPECT_FALSE(rig.luff_bend_m || rig.luff_sag_m);
}

TEST(RigNumbers, NoNumberDependsOnTheFrame) {
  Sail sail = BentSail();
  SetSigma(0.001, &sail.shape);
  const RigNumbers by_lines = SectionsOf(sail).rigs.at(0);
  sail.shape = Moved(ArbitraryMotion(), sail.shape);
  for (const FrameChoice& choice :
       {FrameChoice{FrameKind::kCamera}, FrameChoice{FrameKind::kMarkers, 51, 308, 500}}) {
    const RigNumbers rig = SectionsOf(sail, {}, choice).rigs.at(0);
    EXPECT_NEAR(rig.luff_bend_m->value, by_lines.luff_bend_m->value, 1e-9);
    EXPECT_NEAR(rig.luff_sag_m->value, by_lines.luff_sag_m->value, 1e-9);
    EXPECT_NEAR(rig.sheeting_angle_deg->value, by_lines.sheeting_angle_deg->value, 1e-7);
    EXPECT_NEAR(*rig.luff_bend_m->sigma, *by_lines.luff_bend_m->sigma, 1e-8);
  }
}

// A vertical line along the luff adds its markers; one elsewhere does not.
TEST(RigNumbers, AVerticalLineOnTheLuffIsOfTheLuff) {
  Sail sail = BentSail();
  const auto luff_m = [](double z) {
    const double share = 4 * z * (kHeight_m - z) / (kHeight_m * kHeight_m);
    return Eigen::Vector3d(-share * kBend_m, share * kSag_m, z);
  };
  LayoutPart& part = sail.layout.parts[0];
  ASSERT_EQ(part.vertical.size(), 1u);
  part.vertical[0].marker_ids = {100, 600, 300, 601, 400, 500};
  part.vertical.push_back({"middle", {104, 204, 304, 404, 504}});
  sail.shape.markers.push_back(UprightMarker(600, "sail", luff_m(1.6)));
  sail.shape.markers.push_back(UprightMarker(601, "sail", luff_m(2.3)));
  const RigNumbers rig = SectionsOf(sail).rigs.at(0);
  EXPECT_THAT(rig.luff_marker_ids, ElementsAre(100, 200, 600, 300, 601, 400, 500));
  ExpectLuff(rig, kCenterline_deg);
}

TEST(RigNumbers, TooFewMarkersOfTheLuffGiveNoBend) {
  Sail sail = BentSail();
  RemoveMarker(200, &sail.shape);
  EXPECT_THAT(SectionsOf(sail).rigs.at(0).luff_marker_ids, ElementsAre(100, 300, 400, 500));
  RemoveMarker(400, &sail.shape);
  const RigNumbers rig = SectionsOf(sail).rigs.at(0);
  EXPECT_FALSE(rig.luff_bend_m || rig.luff_sag_m);
  EXPECT_TRUE(rig.luff_marker_ids.empty());
  EXPECT_TRUE(rig.sheeting_angle_deg);
}

TEST(RigNumbers, ALineThatWasLeftOutIsNotBelieved) {
  Sail sail = BentSail();
  sail.layout.parts[0].vertical.clear();
  auto& line = sail.layout.parts[0].horizontal[2].marker_ids;
  std::reverse(line.begin(), line.end());  // its first marker is at the leech
  EXPECT_THAT(SectionsOf(sail).rigs.at(0).luff_marker_ids, ElementsAre(100, 200, 400, 500));
}

// The sail again as part jib, with other ids, forward of the other one and on a raked stay.
Sail Jib() {
  Sail jib = ExampleSail();
  LayoutPart& part = jib.layout.parts[0];
  part.name = "jib";
  for (auto* lines : {&part.horizontal, &part.vertical}) {
    for (MarkerLine& line : *lines) {
      for (int& id : line.marker_ids) id += 1000;
    }
  }
  const Rigid3 raked{Eigen::Quaterniond(Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitY())),
                     {-5, 0.3, 0.2}};
  jib.shape = Moved(raked, jib.shape);
  for (ShapeMarker& marker : jib.shape.markers) {
    marker.marker_id += 1000;
    marker.part = "jib";
  }
  return jib;
}

TEST(RigNumbers, ASailHasTheSameNumbersBesideAnotherOneAndItsBoom) {
  const Sail jib = Jib();
  Sail both = ExampleSail();
  for (int i = 0; i < 2; ++i) {
    both.shape.markers.insert(
        both.shape.markers.begin() + i,
        UprightMarker(51 + i, "boom", Eigen::Vector3d(0.2 + 2 * i, -0.1 * i, -0.3)));
  }
  LayoutPart boom;
  boom.name = "boom";
  boom.marker_ids = {51, 52};
  both.layout.parts.push_back(boom);
  both.layout.parts.push_back(jib.layout.parts[0]);
  both.shape.markers.insert(both.shape.markers.end(), jib.shape.markers.begin(),
                            jib.shape.markers.end());
  const SectionReport alone = SectionsOf(jib), report = SectionsOf(both);
  ASSERT_EQ(report.sections.size(), 6u);
  ASSERT_EQ(report.rigs.size(), 2u);
  EXPECT_EQ(report.rigs[0].twist_reference, "boom");
  EXPECT_EQ(report.rigs[1].twist_reference, "lowest section");
  EXPECT_EQ(report.rigs[1].up_reference, "luff");
  EXPECT_GT(report.sections[0].twist_deg->value, 2);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(report.sections[3 + i].part, "jib");
    const auto a = NumbersOf(alone.sections[i]), b = NumbersOf(report.sections[3 + i]);
    for (std::size_t k = 0; k + 1 < a.size(); ++k) {  // all but the height
      EXPECT_NEAR(a[k], b[k], 1e-7) << report.sections[3 + i].name << " number " << k;
    }
  }
}

// The numbers of which the test below compares the sigma with the scatter.
std::vector<Estimate> Estimates(const SectionReport& report) {
  const RigNumbers& rig = report.rigs.at(0);
  return {rig.luff_bend_m.value(),
          rig.luff_sag_m.value(),
          rig.sheeting_angle_deg.value(),
          report.sections.at(1).girth_m,
          report.sections.at(4).girth_m,
          report.sections.at(1).leech_twist_deg.value(),
          report.sections.at(4).leech_twist_deg.value()};
}

TEST(RigNumbers, SigmasAgreeWithMonteCarlo) {
  constexpr double kSigma_m = 0.002;
  constexpr int kNumRuns = 100;
  Sail sail = BentSail();
  SetSigma(kSigma_m, &sail.shape);
  const FrameChoice camera{FrameKind::kCamera};
  const std::vector<Estimate> stated = Estimates(SectionsOf(sail, {}, camera));
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, kSigma_m);
  std::vector<double> squares(stated.size(), 0.0);
  for (int run = 0; run < kNumRuns; ++run) {
    Sail noisy = sail;
    for (ShapeMarker& marker : noisy.shape.markers) {
      const Eigen::Vector3d shift(noise(random), noise(random), noise(random));
      ShiftMarker(marker.marker_id, shift, &noisy.shape);
    }
    const std::vector<Estimate> drawn = Estimates(SectionsOf(noisy, {}, camera));
    for (std::size_t i = 0; i < stated.size(); ++i) {
      squares[i] += std::pow(drawn[i].value - stated[i].value, 2) / kNumRuns;
    }
  }
  for (std::size_t i = 0; i < stated.size(); ++i) {
    EXPECT_NEAR(std::sqrt(squares[i]) / stated[i].sigma.value(), 1, 0.25) << "number " << i;
  }
}

}  // namespace
}  // namespace velamap
