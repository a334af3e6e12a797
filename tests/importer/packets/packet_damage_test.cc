#include "importer/packets/packet_damage.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace velamap {
namespace {

// One letter a packet: K for a key frame, p for others, l for those shown before their key frame.
// Returns the same with - for what is not whole.
std::string Left(const std::string& packets, const std::vector<int>& damaged) {
  PacketDamage damage;
  std::int64_t time = 0, key_time = 0;
  for (const char packet : packets) {
    time += 10;
    if (packet == 'K') key_time = time;
    damage.Add(packet == 'l' ? key_time - 1 : time, packet == 'K');
  }
  for (const int packet_idx : damaged) damage.Mark(packet_idx);
  std::string left = packets;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    if (!damage.IsWhole(static_cast<std::int64_t>(i))) left[i] = '-';
  }
  return left;
}

TEST(PacketDamage, ReachesToTheNextKeyFrame) {
  EXPECT_EQ(Left("KpppKppp", {}), "KpppKppp");
  EXPECT_EQ(Left("KpppKppp", {2}), "Kp--Kppp");
  EXPECT_EQ(Left("KpppKppp", {0, 4}), "--------");
  EXPECT_EQ(Left("KKKK", {1}), "K-KK");
  EXPECT_EQ(Left("ppppK", {1}), "p---K") << "cut before its first key frame";
}

TEST(PacketDamage, OfPicturesShownBeforeTheirKeyFrameHurtsNoLaterOne) {
  EXPECT_EQ(Left("KppKllpp", {4}), "KppK--pp");
  EXPECT_EQ(Left("KppKllpp", {3}), "Kpp-----");
  EXPECT_EQ(Left("KppKllpp", {1}), "K--K--pp") << "they build on those before it";
}

TEST(PacketDamage, DoesNotEndWithoutAKeyFrame) {
  EXPECT_EQ(Left("K" + std::string(999, 'p'), {100}),
            "K" + std::string(99, 'p') + std::string(900, '-'));
}

TEST(PacketDamage, KnowsNothingOfPacketsThatAreNotThere) {
  PacketDamage damage;
  damage.Mark(3);
  damage.Mark(-1);
  EXPECT_TRUE(damage.IsWhole(3));
  EXPECT_TRUE(damage.IsWhole(-1));
}

}  // namespace
}  // namespace velamap
