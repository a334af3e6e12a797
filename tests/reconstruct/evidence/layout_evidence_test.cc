#include "reconstruct/evidence/layout_evidence.h"

#include <algorithm>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reconstruct/evidence/random_sail.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kNumDraws = 2000;

std::vector<int> IdsOf(const std::vector<Contradiction>& contradictions) {
  std::vector<int> ids;
  for (const Contradiction& contradiction : contradictions) {
    EXPECT_FALSE(contradiction.reason.empty());
    ids.push_back(contradiction.marker_id);
  }
  return ids;
}

std::vector<int> FalseIds(const RandomSail& sail) {
  return IdsOf(FindContradictions(sail.layout, sail.markers));
}

TEST(LayoutEvidence, NoTrueMarkerIsLostWhateverTheSail) {
  std::mt19937 generator(TestSeed());
  for (int draw = 0; draw < kNumDraws; ++draw) {
    const RandomSail sail = DrawSail(Cloth::kTornAtTimes, &generator);
    for (const Contradiction& c : FindContradictions(sail.layout, sail.markers)) {
      ADD_FAILURE() << "draw " << draw << ", step " << sail.step_m << " m: marker " << c.marker_id
                    << " " << c.reason;
    }
  }
}

struct Found {
  int num_false = 0, num_found = 0, num_true_lost = 0;
  double Share() const { return static_cast<double>(num_found) / num_false; }
};

// Moves `num_moved` markers of one sail after the other by 1 to 5 times `num_steps` steps.
Found FindMoved(int num_moved, int min_on_line, double num_steps, Seen seen) {
  std::mt19937 generator(TestSeed());
  Found found;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    RandomSail sail = DrawSail(Cloth::kWhole, &generator);
    std::set<int> moved;
    for (int i = 0; i < num_moved; ++i) {
      const double factor = std::uniform_real_distribution<double>(1, 5)(generator);
      moved.insert(MoveOne(min_on_line, factor * num_steps, seen, &sail, &generator));
    }
    moved.erase(-1);
    found.num_false += static_cast<int>(moved.size());
    for (const int id : FalseIds(sail)) {
      (moved.count(id) > 0 ? found.num_found : found.num_true_lost) += 1;
    }
  }
  EXPECT_GT(found.num_false, kNumDraws / 4);
  return found;
}

TEST(LayoutEvidence, FalseMarkerSeenInFewImagesIsFound) {
  const Found found = FindMoved(1, 5, 8.0, Seen::kSeldom);
  EXPECT_GT(found.Share(), 0.97);
  EXPECT_EQ(found.num_true_lost, 0);
}

TEST(LayoutEvidence, FalseMarkerSeenInMostImagesIsFoundFartherAway) {
  const Found found = FindMoved(1, 5, 16.0, Seen::kOften);
  EXPECT_GT(found.Share(), 0.97);
  EXPECT_EQ(found.num_true_lost, 0);
}

TEST(LayoutEvidence, TwoFalseMarkersAreFound) {
  const Found found = FindMoved(2, 6, 10.0, Seen::kSeldom);
  EXPECT_GT(found.Share(), 0.95);
  EXPECT_EQ(found.num_true_lost, 0);
}

// Three even lines of eight markers, 0.25 m apart, ids 10 to 17, 20 to 27 and 30 to 37, and a
// vertical line through their third markers; all are seen in 40 of 50 images.
RandomSail EvenSail() {
  RandomSail sail;
  sail.step_m = 0.25;
  LayoutPart part;
  part.name = "sail";
  part.vertical.push_back({"v1", {}});
  for (int i = 0; i < 3; ++i) {
    MarkerLine line{"h" + std::to_string(i + 1), {}};
    for (int k = 0; k < 8; ++k) {
      PlacedMarker marker;
      marker.marker_id = 10 * (i + 1) + k;
      marker.center_in_shape_m = {0.25 * k, 0, 0.25 * i};
      marker.num_seen = marker.num_seen_of_these = 40;
      marker.num_should_see = 50;
      line.marker_ids.push_back(marker.marker_id);
      if (k == 2) part.vertical[0].marker_ids.push_back(marker.marker_id);
      sail.markers.push_back(marker);
    }
    part.horizontal.push_back(std::move(line));
  }
  sail.layout.parts.push_back(std::move(part));
  return sail;
}

void SetSeen(int num_seen, PlacedMarker* marker) {
  marker->num_seen = marker->num_seen_of_these = num_seen;
}

TEST(LayoutEvidence, ReasonNamesLineNeighboursAndImages) {
  RandomSail sail = EvenSail();
  sail.Find(24)->center_in_shape_m += Eigen::Vector3d(0, 3.5, 0);
  SetSeen(3, sail.Find(24));
  const auto contradictions = FindContradictions(sail.layout, sail.markers);
  ASSERT_EQ(contradictions.size(), 1u);
  EXPECT_EQ(contradictions[0].marker_id, 24);
  EXPECT_THAT(contradictions[0].reason,
              HasSubstr("on line h2 it is 3.51 m from marker 23 and 3.51 m "
                        "from marker 25"));
  EXPECT_THAT(contradictions[0].reason, HasSubstr("seen in 3 of 50 images"));
}

TEST(LayoutEvidence, OneLineAcquitsWhatAnotherContradicts) {
  RandomSail sail = EvenSail();
  // The whole vertical line has slid along the sail.
  for (const int id : {12, 22, 32}) sail.Find(id)->center_in_shape_m.y() += 3;
  EXPECT_THAT(FalseIds(sail), IsEmpty());
  sail.layout.parts[0].vertical.clear();
  EXPECT_THAT(FalseIds(sail), ElementsAre(12, 22, 32));
}

// Of line h2, only 22, which the vertical line confirms, and 25 are found.
TEST(LayoutEvidence, OfTwoOnALineTheOneThatAnotherLineConfirmsJudges) {
  RandomSail sail = EvenSail();
  const std::set<int> unseen = {20, 21, 23, 24, 26, 27};
  sail.markers.erase(
      std::remove_if(sail.markers.begin(), sail.markers.end(),
                     [&](const PlacedMarker& m) { return unseen.count(m.marker_id) > 0; }),
      sail.markers.end());
  EXPECT_THAT(FalseIds(sail), IsEmpty());
  sail.Find(25)->center_in_shape_m.y() += 3.5;
  EXPECT_THAT(FalseIds(sail), ElementsAre(25));
  // Without the vertical line, nothing says which of the two is wrong.
  sail.layout.parts[0].vertical.clear();
  EXPECT_THAT(FalseIds(sail), IsEmpty());
}

TEST(LayoutEvidence, LineListedInAnotherOrderIsNotBelieved) {
  RandomSail sail = EvenSail();
  auto& ids = sail.layout.parts[0].horizontal[1].marker_ids;
  std::reverse(ids.begin(), ids.end());
  EXPECT_THAT(FalseIds(sail), IsEmpty());
  std::swap(ids[3], ids[4]);
  EXPECT_THAT(FalseIds(sail), IsEmpty());
  std::rotate(ids.begin(), ids.begin() + 3, ids.end());
  EXPECT_THAT(FalseIds(sail), IsEmpty());
  ids = {20, 22, 24, 26, 27, 25, 23, 21};
  EXPECT_THAT(FalseIds(sail), IsEmpty());
}

TEST(LayoutEvidence, WithoutALineTheRarerOfTwoRivalsIsAMisreadId) {
  RandomSail sail = EvenSail();
  sail.Find(33)->rival_ids = {11};
  SetSeen(15, sail.Find(33));
  EXPECT_THAT(IdsOf(FindContradictions({}, sail.markers)), ElementsAre(33));
  SetSeen(5, sail.Find(11));
  EXPECT_THAT(IdsOf(FindContradictions({}, sail.markers)), ElementsAre(11));
}

TEST(LayoutEvidence, LayoutDecidesBetweenRivalsHoweverOftenTheyAreSeen) {
  for (const int num_seen : {2, 10, 40, 50}) {
    RandomSail sail = EvenSail();
    sail.Find(37)->center_in_shape_m = sail.Find(10)->center_in_shape_m;
    sail.Find(37)->rival_ids = {10};
    sail.Find(10)->rival_ids = {37};
    SetSeen(num_seen, sail.Find(10));
    EXPECT_THAT(FalseIds(sail), ElementsAre(37)) << num_seen;
  }
}

TEST(LayoutEvidence, NeighboursOnALineThatIsMisreadAsAWholeDoNotConfirmEachOther) {
  RandomSail sail = EvenSail();
  sail.layout.parts[0].vertical.clear();
  for (int k = 0; k < 3; ++k) {
    PlacedMarker* marker = sail.Find(30 + k);
    marker->center_in_shape_m = sail.Find(14 + k)->center_in_shape_m;
    marker->rival_ids = {14 + k};
  }
  EXPECT_THAT(FalseIds(sail), ElementsAre(30, 31, 32));
}

TEST(LayoutEvidence, MarkerOnNoLineIsNotContradictedByALine) {
  RandomSail sail = EvenSail();
  PlacedMarker on_hull = *sail.Find(36);
  on_hull.marker_id = 50;
  on_hull.rival_ids = {36};
  sail.layout.parts.push_back({"hull", true, {}, {}, {50}});
  sail.markers.push_back(on_hull);
  SetSeen(2, sail.Find(36));
  EXPECT_THAT(FalseIds(sail), ElementsAre(36));
}

// 24 is read where 10 stands and, in other images, where 34 stands. It loses against 10, and what
// is left of its line would win against 34, which is a little off its own line.
TEST(LayoutEvidence, AMisreadIdThatIsGoneContradictsNothing) {
  RandomSail sail = EvenSail();
  sail.layout.parts[0].vertical.clear();
  sail.Find(24)->center_in_shape_m = sail.Find(10)->center_in_shape_m;
  sail.Find(24)->rival_ids = {10, 34};
  sail.Find(34)->center_in_shape_m.y() += 0.4;
  const std::set<int> unseen = {20, 21, 23, 25, 26, 27};
  sail.markers.erase(
      std::remove_if(sail.markers.begin(), sail.markers.end(),
                     [&](const PlacedMarker& m) { return unseen.count(m.marker_id) > 0; }),
      sail.markers.end());
  EXPECT_THAT(FalseIds(sail), ElementsAre(24));
}

TEST(LayoutEvidence, RivalsWithoutALineAreBothDoubted) {
  RandomSail sail = EvenSail();
  Layout layout;
  sail.Find(37)->rival_ids = {10};
  EXPECT_THAT(IdsOf(FindContradictions(layout, sail.markers)), ElementsAre(10, 37));
}

TEST(LayoutEvidence, WithoutLinesOnlyRareMarkersFarFromAllOthersGo) {
  RandomSail sail = EvenSail();
  Layout parts;
  parts.parts.push_back({"hull", true, {}, {}, MarkerIds(sail.layout)});
  for (const Layout& layout : {Layout(), parts}) {
    RandomSail far = sail;
    PlacedMarker* marker = far.Find(24);
    marker->center_in_shape_m.y() += 10;
    EXPECT_THAT(IdsOf(FindContradictions(layout, far.markers)), IsEmpty());
    SetSeen(3, marker);
    EXPECT_THAT(IdsOf(FindContradictions(layout, far.markers)), ElementsAre(24));
    marker->center_in_shape_m.y() = 1;
    EXPECT_THAT(IdsOf(FindContradictions(layout, far.markers)), IsEmpty());
  }
}

TEST(LayoutEvidence, NothingIsSaidOfNothing) {
  EXPECT_THAT(FindContradictions({}, {}), IsEmpty());
  EXPECT_THAT(FindContradictions(EvenSail().layout, {}), IsEmpty());
}

}  // namespace
}  // namespace velamap
