#include "importer/video_seek.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

// I0 P3 B1 B2 | I4 P7 B5 B6 | I8 P11 B9 B10: groups of four in the order of decoding, and enough
// behind them. A frame's number is its time, so that it can be checked.
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

TEST(FindSeekPoint, IsTheLastKeyFrameNotBehindTheFrame) {
  const std::vector<VideoPacket> packets = ClosedGroups(3);
  for (int number = 0; number < 4; ++number) EXPECT_FALSE(FindSeekPoint(packets, number)) << number;
  for (int number = 4; number < 30; ++number) {
    const std::optional<SeekPoint> point = FindSeekPoint(packets, number);
    ASSERT_TRUE(point) << number;
    EXPECT_EQ(point->frame_number, number < 8 ? 4 : 8);
    EXPECT_EQ(point->time, point->frame_number);
  }
}

TEST(FindSeekPoint, CountsFramesNotTimes) {
  // A variable frame rate, and a first time that is not 0.
  std::vector<VideoPacket> packets = ClosedGroups(4);
  for (VideoPacket& packet : packets) packet.time = 1000 + packet.time * packet.time;
  const std::optional<SeekPoint> point = FindSeekPoint(packets, 13);
  ASSERT_TRUE(point);
  EXPECT_EQ(point->frame_number, 12);
  EXPECT_EQ(point->time, 1144);
}

TEST(FindSeekPoint, FramesShownBeforeAKeyFrameButStoredBehindItCount) {
  // Open groups: B6 and B7 follow I8 in the file.
  std::vector<VideoPacket> packets;
  for (const int time : {0, 4, 2, 3, 1, 8, 6, 7, 5, 10, 9})
    packets.push_back({time, time % 8 == 0});
  for (int time = 11; time < 30; ++time) packets.push_back({time, false});
  EXPECT_FALSE(FindSeekPoint(packets, 7));
  const std::optional<SeekPoint> point = FindSeekPoint(packets, 9);
  ASSERT_TRUE(point);
  EXPECT_EQ(point->frame_number, 8);
}

TEST(FindSeekPoint, PicturesCutAwayByTheContainerDoNotCount) {
  std::vector<VideoPacket> packets = ClosedGroups(3);
  for (VideoPacket& packet : packets) packet.is_shown = packet.time >= 2;
  const std::optional<SeekPoint> point = FindSeekPoint(packets, 3);
  ASSERT_TRUE(point);
  EXPECT_EQ(point->time, 4);
  EXPECT_EQ(point->frame_number, 2);
}

TEST(FindSeekPoint, KeyFramesCloseToTheEndAreNotTaken) {
  std::vector<VideoPacket> packets = ClosedGroups(3);
  packets.pop_back();
  const std::optional<SeekPoint> point = FindSeekPoint(packets, 20);
  ASSERT_TRUE(point);
  EXPECT_EQ(point->frame_number, 8);
  packets.resize(8 + kMaxReorder);
  EXPECT_EQ(FindSeekPoint(packets, 20)->frame_number, 4);
}

TEST(FindSeekPoint, TellsTheTimeOfDecoding) {
  std::vector<VideoPacket> packets = ClosedGroups(3);
  packets[8].decode_time = 6;
  EXPECT_EQ(FindSeekPoint(packets, 9)->decode_time, 6);
  EXPECT_EQ(FindSeekPoint(packets, 7)->decode_time, 4) << "not known";
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
  const std::optional<SeekPoint> point = FindSeekPoint(packets, 9);
  ASSERT_TRUE(point);
  EXPECT_EQ(point->frame_number, 4);
}

}  // namespace
}  // namespace velamap
