#include "importer/packets/video_seek.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace velamap {
namespace {

// I0 P3 B1 B2 | I4 P7 B5 B6 | I8 P11 B9 B10: groups of four in the order of decoding, followed by
// more packets than any codec reorders. The time of a frame is its number.
std::vector<VideoPacket> ClosedGroups(int num_groups) {
  std::vector<VideoPacket> packets;
  for (int i = 0; i < num_groups; ++i) {
    for (const int k : {0, 3, 1, 2}) packets.push_back({4 * i + k, k == 0});
  }
  for (std::size_t i = 0; i < kMaxReorder; ++i) {
    packets.push_back({static_cast<std::int64_t>(packets.size()), false});
  }
  return packets;
}

TEST(FindSeekPoint, BeginsAtTheLastKeyFrameNotBehindTheFrame) {
  const std::vector<VideoPacket> packets = ClosedGroups(3);
  for (int number = 0; number < 40; ++number) {
    const std::optional<SeekPoint> point = FindSeekPoint(packets, number);
    ASSERT_TRUE(point) << number;
    EXPECT_EQ(point->key_time, number < 4 ? 0 : number < 8 ? 4 : 8);
    EXPECT_EQ(point->is_start, number < 4);
    EXPECT_EQ(point->frame_number, std::min(number, 27));
    EXPECT_EQ(point->time, point->frame_number);
    EXPECT_EQ(point->skip_before_time, std::max(0, point->frame_number - 16));
  }
}

TEST(FindSeekPoint, CountsFramesNotTimes) {
  // A variable frame rate, and a first time that is not 0.
  std::vector<VideoPacket> packets = ClosedGroups(4);
  for (VideoPacket& packet : packets) packet.time = 1000 + packet.time * packet.time;
  const std::optional<SeekPoint> point = FindSeekPoint(packets, 13);
  ASSERT_TRUE(point);
  EXPECT_EQ(point->frame_number, 13);
  EXPECT_EQ(point->time, 1000 + 13 * 13);
  EXPECT_EQ(point->key_time, 1000 + 12 * 12);
}

TEST(FindSeekPoint, FramesShownBeforeAKeyFrameButStoredBehindIt) {
  // Open groups: B6 and B7 follow I8 in the file.
  std::vector<VideoPacket> packets;
  for (const int time : {0, 4, 2, 3, 1, 8, 6, 7, 5, 10, 9})
    packets.push_back({time, time % 8 == 0});
  for (int time = 11; time < 30; ++time) packets.push_back({time, false});
  EXPECT_EQ(FindSeekPoint(packets, 7)->key_time, 0);
  EXPECT_EQ(FindSeekPoint(packets, 9)->key_time, 8);
  EXPECT_EQ(FindSeekPoint(packets, 9)->time, 9);
}

TEST(FindSeekPoint, PicturesCutAwayByTheContainerDoNotCount) {
  std::vector<VideoPacket> packets = ClosedGroups(3);
  for (VideoPacket& packet : packets) packet.is_shown = packet.time >= 2;
  const std::optional<SeekPoint> point = FindSeekPoint(packets, 3);
  ASSERT_TRUE(point);
  EXPECT_EQ(point->time, 5);
  EXPECT_EQ(point->frame_number, 3);
  EXPECT_EQ(point->key_time, 4);
}

TEST(FindSeekPoint, KeyFramesCloseToTheEndAreNotTaken) {
  std::vector<VideoPacket> packets = ClosedGroups(3);
  packets.resize(9 + kMaxReorder);
  EXPECT_EQ(FindSeekPoint(packets, 20)->key_time, 8);
  packets.pop_back();
  EXPECT_EQ(FindSeekPoint(packets, 20)->key_time, 4);
}

TEST(FindSeekPoint, TellsTheTimeOfDecoding) {
  std::vector<VideoPacket> packets = ClosedGroups(3);
  packets[8].decode_time = 6;
  EXPECT_EQ(FindSeekPoint(packets, 9)->key_decode_time, 6);
  EXPECT_EQ(FindSeekPoint(packets, 7)->key_decode_time, 4) << "not known";
}

TEST(FindSeekPoint, DoubtMeansFromTheStart) {
  std::vector<VideoPacket> packets = ClosedGroups(3);
  packets[5].time = VideoPacket::kNoTime;
  EXPECT_FALSE(FindSeekPoint(packets, 9));
  packets = ClosedGroups(3);
  packets[5].time = packets[6].time;
  EXPECT_FALSE(FindSeekPoint(packets, 9));
  packets = ClosedGroups(3);
  packets[1].time = -1;  // shown before the first key frame
  EXPECT_FALSE(FindSeekPoint(packets, 9));
  packets = ClosedGroups(3);
  packets[0].is_key = false;
  EXPECT_FALSE(FindSeekPoint(packets, 9));
  EXPECT_FALSE(FindSeekPoint({}, 9));
  // Shown behind the last key frame, decoded before it.
  packets = ClosedGroups(3);
  packets[5].time = 200;
  EXPECT_EQ(FindSeekPoint(packets, 9)->key_time, 4);
}

}  // namespace
}  // namespace velamap
