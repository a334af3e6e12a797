#include "workflows/check/clip_ids.h"

#include <gmock/gmock.h>

#include "workflows/check/dictionary_search.h"

namespace velamap {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Key;
using testing::Not;
using testing::Pair;

MarkerDetection Marker(int marker_id) {
  MarkerDetection marker;
  marker.marker_id = marker_id;
  return marker;
}

// Markers 1 to 3 in each of 20 frames, and an id in the first `num_frames` of them that no layout
// names.
std::vector<DatabaseImage> Images(int unnamed_id, int num_frames, bool is_rejected) {
  std::vector<DatabaseImage> images(20);
  for (int i = 0; i < 20; ++i) {
    FrameDetections& frame = images[static_cast<std::size_t>(i)].detections;
    frame.markers = {Marker(1), Marker(2), Marker(3)};
    if (i >= num_frames) continue;
    if (is_rejected) {
      frame.rejected.push_back({Marker(unnamed_id), kNotInLayout});
    } else {
      frame.markers.push_back(Marker(unnamed_id));
    }
  }
  return images;
}

Layout FourMarkers() {
  Layout layout = MakeLayout("DICT_4X4_250", 0.1);
  layout.parts.emplace_back();
  layout.parts[0].name = "sail";
  layout.parts[0].marker_ids = {1, 2, 3, 4};
  return layout;
}

TEST(ClipIds, WhatIsReadRarelyIsNoMarkerThatTheLayoutLacks) {
  ClipFacts facts;
  CollectIds(Images(244, 3, true), FourMarkers(), &facts);
  EXPECT_THAT(facts.ids_not_in_layout, IsEmpty());
  EXPECT_THAT(facts.ids_read_rarely, ElementsAre(244));
  EXPECT_THAT(facts.ids_never_seen, ElementsAre(4));
  EXPECT_THAT(facts.num_frames_of_id, ElementsAre(Pair(1, 20), Pair(2, 20), Pair(3, 20)));
}

TEST(ClipIds, WhatIsReadOftenIs) {
  ClipFacts facts;
  CollectIds(Images(244, 5, true), FourMarkers(), &facts);
  EXPECT_THAT(facts.ids_not_in_layout, ElementsAre(244));
  EXPECT_THAT(facts.ids_read_rarely, IsEmpty());
}

TEST(ClipIds, WithoutALayoutARareIdIsNoMarker) {
  ClipFacts facts;
  CollectIds(Images(244, 3, false), MakeLayout("DICT_4X4_250", 0.1), &facts);
  EXPECT_THAT(facts.num_frames_of_id, Not(Contains(Key(244))));
  EXPECT_THAT(facts.ids_read_rarely, ElementsAre(244));
}

// A busy picture holds more false codes than markers, each of them in one frame.
TEST(ClipIds, ManyFalseIdsDoNotHideThatTheyAreRare) {
  std::vector<DatabaseImage> images = Images(244, 0, false);
  for (int i = 0; i < 20; ++i) {
    images[static_cast<std::size_t>(i)].detections.markers.push_back(Marker(500 + i));
  }
  ClipFacts facts;
  CollectIds(images, MakeLayout("DICT_4X4_1000", 0.1), &facts);
  EXPECT_THAT(facts.num_frames_of_id, ElementsAre(Pair(1, 20), Pair(2, 20), Pair(3, 20)));
  EXPECT_EQ(DictionaryOfIds(images, "DICT_4X4_1000"), "DICT_4X4_50");
}

TEST(ClipIds, TheDictionaryHoldsAllIdsThatAreNotRare) {
  EXPECT_EQ(DictionaryOfIds(Images(100, 5, false), "DICT_4X4_1000"), "DICT_4X4_250");
  EXPECT_EQ(DictionaryOfIds(Images(100, 3, false), "DICT_4X4_1000"), "DICT_4X4_50");
  EXPECT_EQ(DictionaryOfIds({}, "DICT_4X4_1000"), "DICT_4X4_50");
}

// Filming longer helps at the end of a line, but not between markers that are seen.
TEST(ClipIds, UnseenMarkersBetweenSeenOnesAreToldFromThoseAtTheEnds) {
  Layout layout = MakeLayout("DICT_4X4_250", 0.1);
  layout.parts.emplace_back();
  layout.parts[0].horizontal = {{"h1", {8, 1, 5, 6, 2, 9}}, {"h2", {3, 7}}};
  layout.parts[0].vertical = {{"v1", {1, 4, 3}}};
  ClipFacts facts;
  CollectIds(Images(244, 0, false), layout, &facts);
  EXPECT_THAT(facts.ids_never_seen, ElementsAre(4, 5, 6, 7, 8, 9));
  EXPECT_THAT(facts.ids_unseen_between_seen, ElementsAre(4, 5, 6));
}

TEST(ClipIds, WithoutPicturesNoMarkerIsSeen) {
  ClipFacts facts;
  CollectIds({}, FourMarkers(), &facts);
  EXPECT_THAT(facts.ids_never_seen, ElementsAre(1, 2, 3, 4));
}

}  // namespace
}  // namespace velamap
