// Layouts from markers whose places are known exactly.

#include "workflows/proposal/layout_proposal.h"

#include <algorithm>
#include <fstream>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include "importer/layout/layout_writer.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"
#include "workflows/options/shared_options.h"
#include "workflows/proposal/layout_correction.h"

namespace velamap {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kSail = std::string(VELAMAP_SOURCE_DIR) + "/sample_project/sail/";

// The true places of the sample's sail and hull, with sides that are as the layout says.
ClipMap SampleSail() {
  ClipMap map;
  map.bodies.emplace_back();
  for (const auto& [marker_id, corners] : LoadPriorShape(kSail + "truth.csv")) {
    MarkerPoints& points = map.bodies[0][marker_id];
    points[0].setZero();
    for (std::size_t c = 0; c < corners.size(); ++c) {
      points[c + 1] = corners[c];
      points[0] += 0.25 * corners[c];
    }
    map.sides[marker_id] = {0.1, 2e-4};
  }
  return map;
}

Layout SampleLayout() { return ReadLayout(kSail + "layout.yml"); }

std::vector<std::vector<int>> Lines(const std::vector<MarkerLine>& lines) {
  std::vector<std::vector<int>> ids;
  for (const MarkerLine& line : lines) ids.push_back(line.marker_ids);
  return ids;
}

void ExpectSameLines(const Layout& layout, const Layout& truth) {
  ASSERT_EQ(layout.parts.size(), truth.parts.size());
  for (std::size_t i = 0; i < truth.parts.size(); ++i) {
    EXPECT_EQ(Lines(layout.parts[i].horizontal), Lines(truth.parts[i].horizontal));
    EXPECT_EQ(Lines(layout.parts[i].vertical), Lines(truth.parts[i].vertical));
    EXPECT_EQ(layout.parts[i].marker_ids, truth.parts[i].marker_ids);
    EXPECT_EQ(layout.parts[i].rigid, truth.parts[i].rigid);
  }
}

TEST(LayoutProposal, TheSampleSailsLinesComeBack) {
  const LayoutProposal proposal = ProposeLayout(SampleSail(), MakeLayout("DICT_4X4_250", 0.1));
  ExpectSameLines(proposal.layout, SampleLayout());
  EXPECT_THAT(proposal.contradictions, IsEmpty());
  EXPECT_TRUE(proposal.layout.marker_lengths_m.empty());
  EXPECT_THAT(proposal.notes, Contains(AllOf(HasSubstr("luff"), HasSubstr("on the left"))));
  EXPECT_THAT(proposal.notes, Contains(AllOf(HasSubstr("NOT SURE"), HasSubstr("rigid"))));
}

TEST(LayoutProposal, ItsFileReadsBack) {
  const TempDir dir;
  const LayoutProposal proposal = ProposeLayout(SampleSail(), MakeLayout("DICT_4X4_250", 0.1));
  const std::string path = (dir.path() / "layout.yml").string();
  std::ofstream(path) << LayoutText(proposal.layout, "a note\nand another one\n");
  ExpectSameLines(ReadLayout(path), SampleLayout());
}

TEST(LayoutProposal, MarkersOfAnotherLengthGetIt) {
  ClipMap map = SampleSail();
  for (const int id : {94, 95, 96, 97}) map.sides[id] = {0.05003, 1e-4};
  map.sides[20] = {0.1006, 2e-4};  // a print that is a little too large is no other length
  const LayoutProposal proposal = ProposeLayout(map, MakeLayout("DICT_4X4_250", 0.1));
  EXPECT_THAT(proposal.layout.marker_lengths_m,
              ElementsAre(testing::Pair(94, 0.05), testing::Pair(95, 0.05), testing::Pair(96, 0.05),
                          testing::Pair(97, 0.05)));
  EXPECT_THAT(proposal.notes, Contains(AllOf(HasSubstr("94-97"), HasSubstr("50.03"))));
}

// A length that was measured well is not rounded to one that it contradicts.
TEST(LayoutProposal, ALengthIsRoundedOnlyAsFarAsItsSigmaAllows) {
  const auto proposed_m = [](double length_m, double sigma_m) {
    ClipMap map = SampleSail();
    map.sides[94] = {length_m, sigma_m};
    return ProposeLayout(map, MakeLayout("DICT_4X4_250", 0.1)).layout.marker_lengths_m.at(94);
  };
  EXPECT_EQ(proposed_m(0.0964, 3e-5), 0.0964);
  EXPECT_EQ(proposed_m(0.09638, 3e-5), 0.0964);
  EXPECT_EQ(proposed_m(0.09638, 3e-4), 0.096);
  EXPECT_EQ(proposed_m(0.096384, 3e-6), 0.09638);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> length_m(0.02, 0.09), log_sigma(-6, -3);
  for (int i = 0; i < 100; ++i) {
    const double measured_m = length_m(random), sigma_m = std::pow(10, log_sigma(random));
    EXPECT_LE(std::abs(proposed_m(measured_m, sigma_m) - measured_m), 2 * sigma_m + 1e-9);
  }
}

TEST(LayoutProposal, ARectangleDoesNotSayWhereItsLuffIs) {
  const SyntheticScene scene = MakeSyntheticScene({});
  ClipMap map;
  map.bodies.emplace_back(scene.x_in_world.begin(), scene.x_in_world.end());
  EXPECT_THAT(ProposeLayout(map, MakeLayout("DICT_5X5_1000", 0.1)).notes,
              Contains(AllOf(HasSubstr("NOT SURE"), HasSubstr("luff"))));
}

TEST(LayoutProposal, DiagonalsOfAChessboardAreNoLines) {
  ClipMap map;
  map.bodies.emplace_back();
  for (int i = 0; i < 64; ++i) {
    if ((i / 8 + i % 8) % 2 == 0) continue;
    const Eigen::Vector3d center(0.1 * (i % 8), 0.0, 0.1 * (i / 8));
    map.bodies[0][i] = {
        center, center + Eigen::Vector3d(-0.03, 0, 0.03), center + Eigen::Vector3d(0.03, 0, 0.03),
        center + Eigen::Vector3d(0.03, 0, -0.03), center + Eigen::Vector3d(-0.03, 0, -0.03)};
  }
  const LayoutProposal proposal = ProposeLayout(map, MakeLayout("DICT_4X4_250", 0.1));
  ASSERT_EQ(proposal.layout.parts.size(), 1u);
  EXPECT_TRUE(proposal.layout.parts[0].horizontal.empty());
  EXPECT_TRUE(proposal.layout.parts[0].vertical.empty());
  EXPECT_EQ(proposal.layout.parts[0].marker_ids.size(), 32u);
  EXPECT_THAT(proposal.notes, Contains(HasSubstr("NOT SURE of its lines")));
}

// Rows of markers on the faces of a box are no lines of a sail.
TEST(LayoutProposal, FacesOfABoxAreRigidPartsWithoutLines) {
  SyntheticSceneOptions options;
  options.kind = SceneKind::kCube;
  options.num_rows = 4;
  options.num_columns = 4;
  const SyntheticScene scene = MakeSyntheticScene(options);
  ClipMap map;
  map.bodies.emplace_back(scene.x_in_world.begin(), scene.x_in_world.end());
  std::mt19937 random(7);
  std::normal_distribution<double> noise_m(0.0, 0.5e-3);
  for (auto& [marker_id, points] : map.bodies[0]) {
    for (Eigen::Vector3d& x : points) {
      for (double& coordinate : x) coordinate += noise_m(random);
    }
  }
  const LayoutProposal proposal = ProposeLayout(map, MakeLayout("DICT_5X5_1000", 0.1));
  ASSERT_EQ(proposal.layout.parts.size(), scene.layout.parts.size());
  for (const LayoutPart& part : proposal.layout.parts) {
    EXPECT_TRUE(part.rigid);
    EXPECT_TRUE(part.horizontal.empty() && part.vertical.empty());
    EXPECT_EQ(part.marker_ids.size(), 16u);
    std::set<std::string> true_faces;
    for (const int id : part.marker_ids) true_faces.insert(PartOfMarker(scene.layout, id));
    EXPECT_EQ(true_faces.size(), 1u) << part.name;
  }
  EXPECT_THAT(proposal.notes, Contains(AllOf(HasSubstr("face6"), HasSubstr("one plane"))));
}

TEST(LayoutCorrection, ALayoutThatIsRightStaysAsItIs) {
  const LayoutProposal correction = CorrectLayout(SampleSail(), SampleLayout());
  EXPECT_THAT(correction.contradictions, IsEmpty());
  ExpectSameLines(correction.layout, SampleLayout());
}

TEST(LayoutCorrection, SwappedNeighboursAreNamedAndPutRight) {
  Layout given = SampleLayout();
  std::vector<int>& line = given.parts[0].horizontal[2].marker_ids;
  std::swap(line[7], line[8]);  // 39 and 40
  const LayoutProposal correction = CorrectLayout(SampleSail(), given);
  EXPECT_THAT(correction.contradictions,
              ElementsAre(AllOf(HasSubstr("line h3"), HasSubstr("39 and 40"))));
  ExpectSameLines(correction.layout, SampleLayout());
}

TEST(LayoutCorrection, AMarkerOfAnotherLineIsNamedAndPutRight) {
  Layout given = SampleLayout();
  std::swap(given.parts[0].horizontal[1].marker_ids[3], given.parts[0].horizontal[4].marker_ids[5]);
  const LayoutProposal correction = CorrectLayout(SampleSail(), given);
  EXPECT_THAT(correction.contradictions,
              ElementsAre(AllOf(HasSubstr("line h2: marker 20 stands between markers 19 and 21"),
                                HasSubstr("on line h5")),
                          AllOf(HasSubstr("line h5: marker 61"), HasSubstr("on line h2"))));
  ExpectSameLines(correction.layout, SampleLayout());
}

TEST(LayoutCorrection, ALineThatItForgotIsAdded) {
  Layout given = SampleLayout();
  const std::vector<int> line = given.parts[0].horizontal[2].marker_ids;
  given.parts[0].horizontal.erase(given.parts[0].horizontal.begin() + 2);
  const LayoutProposal correction = CorrectLayout(SampleSail(), given);
  EXPECT_THAT(correction.contradictions,
              ElementsAre(HasSubstr("stand on a line that the layout does not name")));
  EXPECT_THAT(correction.notes, Contains(AllOf(HasSubstr("NOT SURE"), HasSubstr("it is new"))));
  EXPECT_EQ(correction.layout.parts[0].horizontal.back().marker_ids, line);
}

// The distances of an edge belong to the lines in their order.
TEST(LayoutCorrection, DistancesOfAnEdgeGoWhenOneLineIsAddedAndAnotherRemoved) {
  Layout given = SampleLayout();
  LayoutPart& sail = given.parts[0];
  sail.edges.luff.offsets_m = {0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07};
  sail.edges.foot.offsets_m = {0.1};
  EXPECT_EQ(CorrectLayout(SampleSail(), given).layout.parts[0].edges.luff.offsets_m.size(), 7u);
  sail.horizontal[2] = {"x", {20, 50}};  // in place of a line, two markers of others
  const LayoutProposal correction = CorrectLayout(SampleSail(), given);
  const LayoutPart& corrected = correction.layout.parts[0];
  EXPECT_EQ(corrected.horizontal.size(), 7u);
  EXPECT_TRUE(corrected.edges.luff.offsets_m.empty());
  EXPECT_EQ(corrected.edges.foot.offsets_m.size(), 1u);
  EXPECT_THAT(correction.notes, Contains(HasSubstr("the edge with a distance for each line")));
}

// A layout whose edge names what is no longer there could not be read.
TEST(LayoutCorrection, AnEdgeGoesWithItsLineOrItsPoints) {
  Layout given = SampleLayout();
  LayoutPart& sail = given.parts[0];
  sail.edges.head.line = sail.horizontal.back().name;
  sail.edges.leech.points = {{sail.horizontal[0].marker_ids.back(), 3},
                             {sail.horizontal[1].marker_ids.back(), 3}};
  const LayoutProposal kept = CorrectLayout(SampleSail(), given);
  EXPECT_EQ(kept.layout.parts[0].edges.head.line, sail.edges.head.line);
  EXPECT_EQ(kept.layout.parts[0].edges.leech.points.size(), 2u);
  sail.horizontal.push_back({"x", {20, 50}});  // markers of other lines
  sail.edges.head.line = "x";
  const LayoutProposal correction = CorrectLayout(SampleSail(), given);
  EXPECT_FALSE(correction.layout.parts[0].edges.head.IsKnown());
  EXPECT_THAT(correction.notes, Contains(HasSubstr("an edge is left out, because its line")));
  EXPECT_TRUE(correction.layout.parts[0].edges.leech.IsKnown());
}

TEST(LayoutCorrection, AMarkerOnTwoLinesIsNamedAndTakenOffTheWrongOne) {
  Layout given = SampleLayout();
  std::vector<int>& line = given.parts[0].horizontal[0].marker_ids;
  line.insert(line.begin() + 4, 46);
  const LayoutProposal correction = CorrectLayout(SampleSail(), given);
  EXPECT_THAT(correction.contradictions,
              ElementsAre(AllOf(HasSubstr("line h1: marker 46"), HasSubstr("on line h4 only"))));
  ExpectSameLines(correction.layout, SampleLayout());
}

TEST(LayoutCorrection, AWrongCrossingIsNamedAndPutRight) {
  Layout given = SampleLayout();
  std::swap(given.parts[0].horizontal[0].marker_ids[7], given.parts[0].horizontal[0].marker_ids[8]);
  given.parts[0].vertical[0].marker_ids[0] = 8;
  const LayoutProposal correction = CorrectLayout(SampleSail(), given);
  EXPECT_THAT(correction.contradictions,
              ElementsAre(HasSubstr("line h1: markers 7 and 8 are in the opposite order"),
                          HasSubstr("line v1: marker 7 stands before marker 76")));
  ExpectSameLines(correction.layout, SampleLayout());
}

TEST(LayoutCorrection, ALineThatRunsBackwardsIsNamedAndTurned) {
  Layout given = SampleLayout();
  std::vector<int>& line = given.parts[0].horizontal[3].marker_ids;
  std::reverse(line.begin(), line.end());
  const LayoutProposal correction = CorrectLayout(SampleSail(), given);
  EXPECT_THAT(correction.contradictions,
              ElementsAre(AllOf(HasSubstr("line h4"), HasSubstr("opposite"),
                                HasSubstr("from marker 45 to 55"))));
  ExpectSameLines(correction.layout, SampleLayout());
}

TEST(LayoutCorrection, LinesMayAllRunFromTheLeechAsTheCameraSeesThem) {
  Layout given = SampleLayout();
  for (MarkerLine& line : given.parts[0].horizontal) {
    std::reverse(line.marker_ids.begin(), line.marker_ids.end());
  }
  const LayoutProposal correction = CorrectLayout(SampleSail(), given);
  EXPECT_THAT(correction.contradictions, IsEmpty());
  ExpectSameLines(correction.layout, given);
}

TEST(LayoutCorrection, AWrongLengthIsNamedAndPutRight) {
  Layout given = SampleLayout();
  given.marker_lengths_m[12] = 0.05;
  const LayoutProposal correction = CorrectLayout(SampleSail(), given);
  EXPECT_THAT(
      correction.contradictions,
      ElementsAre(AllOf(HasSubstr("marker 12"), HasSubstr("100.0 mm"), HasSubstr("50 mm"))));
  EXPECT_TRUE(correction.layout.marker_lengths_m.empty());
}

TEST(LayoutCorrection, WhatTheClipDoesNotShowStays) {
  ClipMap map = SampleSail();
  for (const int id : {0, 5, 31, 80, 93, 99}) map.bodies[0].erase(id);
  const LayoutProposal correction = CorrectLayout(map, SampleLayout());
  EXPECT_THAT(correction.contradictions, IsEmpty());
  ExpectSameLines(correction.layout, SampleLayout());
}

TEST(LayoutCorrection, MarkersThatItForgotAreAdded) {
  Layout given = SampleLayout();
  given.parts[0].horizontal[2].marker_ids.erase(given.parts[0].horizontal[2].marker_ids.begin() +
                                                6);
  given.parts[1].marker_ids.pop_back();
  const LayoutProposal correction = CorrectLayout(SampleSail(), given);
  EXPECT_THAT(correction.contradictions,
              ElementsAre(AllOf(HasSubstr("line h3: marker 38"), HasSubstr("does not name it")),
                          AllOf(HasSubstr("markers 101"), HasSubstr("does not name them"))));
  ExpectSameLines(correction.layout, SampleLayout());
}

}  // namespace
}  // namespace velamap
