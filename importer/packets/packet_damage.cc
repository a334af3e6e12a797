#include "importer/packets/packet_damage.h"

#include <algorithm>

namespace velamap {
namespace {

// A stream without key frames renews its pictures bit by bit within some seconds.
constexpr int kMaxReach = 300;

}  // namespace

std::int64_t PacketDamage::Add(std::int64_t time, bool is_key) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (is_key) key_time_ = time;
  packets_.push_back({is_key, time != VideoPacket::kNoTime && time < key_time_, false});
  return static_cast<std::int64_t>(packets_.size()) - 1;
}

void PacketDamage::Mark(std::int64_t packet_idx) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (packet_idx < 0 || packet_idx >= static_cast<std::int64_t>(packets_.size())) return;
  packets_[static_cast<std::size_t>(packet_idx)].is_damaged = true;
}

bool PacketDamage::IsWhole(std::int64_t packet_idx) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (packet_idx < 0 || packet_idx >= static_cast<std::int64_t>(packets_.size())) return true;
  const bool is_leading = packets_[static_cast<std::size_t>(packet_idx)].is_leading;
  int num_keys_to_pass = is_leading ? 1 : 0;
  for (std::int64_t i = packet_idx; i >= 0 && packet_idx - i < kMaxReach; --i) {
    const Packet& packet = packets_[static_cast<std::size_t>(i)];
    const bool is_built_upon = i == packet_idx || is_leading || !packet.is_leading;
    if (packet.is_damaged && is_built_upon) return false;
    if (packet.is_key && num_keys_to_pass-- == 0) return true;
  }
  return true;
}

int PacketDamage::NumDamaged() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return static_cast<int>(std::count_if(packets_.begin(), packets_.end(),
                                        [](const Packet& packet) { return packet.is_damaged; }));
}

}  // namespace velamap
