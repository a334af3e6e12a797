// Tells which frames of a video are damaged: those of damaged packets, and those that depend on
// them.

#pragma once

#include <cstdint>
#include <mutex>
#include <set>
#include <vector>

#include "importer/packets/video_seek.h"

namespace velamap {

// Packets are numbered from 0 in the order of decoding. Thread-safe, because FFmpeg's threads
// report damage while later packets are read.
class PacketDamage {
 public:
  // Adds the next packet and returns its number. `time` is the presentation time, or
  // VideoPacket::kNoTime.
  std::int64_t Add(std::int64_t time, bool is_key);

  void Mark(std::int64_t packet_idx);

  // Whether the frame of this packet shows what was recorded. A decoder conceals damage with other
  // pixels, and the frames up to the next key frame copy these. Leading pictures (stored after a
  // key frame, shown before it) may depend on frames before that key frame; no frame shown after it
  // depends on them. All packets up to this one must have been decoded. In a stream that refreshes
  // its pictures gradually (intra refresh), without key frames, no frame after the first damage
  // counts as whole.
  bool IsWhole(std::int64_t packet_idx) const;

 private:
  struct Packet {
    std::int64_t first_idx;  // of the packets that it may build on
    bool is_leading;         // shown before the key frame that it follows
  };

  mutable std::mutex mutex_;
  std::vector<Packet> packets_;
  std::set<std::int64_t> damaged_idxs_;
  std::int64_t earlier_key_idx_ = 0, key_idx_ = 0;  // of the last two key frames
  std::int64_t key_time_ = VideoPacket::kNoTime;    // of the last key frame
};

}  // namespace velamap
