#include "importer/packets/packet_damage.h"

namespace velamap {

std::int64_t PacketDamage::Add(std::int64_t time, bool is_key) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto packet_idx = static_cast<std::int64_t>(packets_.size());
  if (is_key) {
    earlier_key_idx_ = key_idx_;
    key_idx_ = packet_idx;
    key_time_ = time;
  }
  const bool is_leading = time != VideoPacket::kNoTime && time < key_time_;
  packets_.push_back({is_leading ? earlier_key_idx_ : key_idx_, is_leading});
  return packet_idx;
}

void PacketDamage::Mark(std::int64_t packet_idx) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (packet_idx < 0 || packet_idx >= static_cast<std::int64_t>(packets_.size())) return;
  damaged_idxs_.insert(packet_idx);
}

bool PacketDamage::IsWhole(std::int64_t packet_idx) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (packet_idx < 0 || packet_idx >= static_cast<std::int64_t>(packets_.size())) return true;
  const Packet& packet = packets_[static_cast<std::size_t>(packet_idx)];
  for (auto it = damaged_idxs_.lower_bound(packet.first_idx);
       it != damaged_idxs_.end() && *it <= packet_idx; ++it) {
    const bool is_built_upon = *it == packet_idx || packet.is_leading ||
                               !packets_[static_cast<std::size_t>(*it)].is_leading;
    if (is_built_upon) return false;
  }
  return true;
}

}  // namespace velamap
