#include "importer/packets/video_seek.h"

#include <algorithm>
#include <cstddef>

namespace velamap {

std::optional<SeekPoint> FindSeekPoint(const std::vector<VideoPacket>& packets, int frame_number) {
  if (packets.empty() || frame_number < 0 || !packets.front().is_key) return std::nullopt;
  const bool runs_backwards =
      std::adjacent_find(packets.begin(), packets.end(),
                         [](const VideoPacket& packet, const VideoPacket& next) {
                           return next.decode_time != VideoPacket::kNoTime &&
                                  next.decode_time < packet.decode_time;
                         }) != packets.end();
  if (runs_backwards) return std::nullopt;
  std::vector<std::int64_t> times;
  for (const VideoPacket& packet : packets) {
    if (packet.time == VideoPacket::kNoTime) return std::nullopt;
    if (packet.is_shown) times.push_back(packet.time);
  }
  std::sort(times.begin(), times.end());
  const bool is_repeated = std::adjacent_find(times.begin(), times.end()) != times.end();
  if (times.empty() || is_repeated || times.front() < packets.front().time) return std::nullopt;

  const std::size_t wanted = std::min(static_cast<std::size_t>(frame_number), times.size() - 1);
  const VideoPacket* key = &packets.front();
  std::int64_t latest = packets.front().time;  // among all packets so far
  for (std::size_t i = 0; i + kMaxReorder < packets.size(); ++i) {
    const VideoPacket& packet = packets[i];
    // Pictures that are decoded before the key frame would be missing if they were shown after it.
    if (packet.is_key && packet.is_shown && packet.time > latest && packet.time <= times[wanted]) {
      key = &packet;
    }
    latest = std::max(latest, packet.time);
  }
  SeekPoint point;
  point.key_time = key->time;
  point.key_decode_time = key->decode_time == VideoPacket::kNoTime ? key->time : key->decode_time;
  point.is_start = key == &packets.front();
  point.time = times[wanted];
  point.frame_number = static_cast<int>(wanted);
  point.skip_before_time = times[wanted - std::min(wanted, kMaxReorder)];
  return point;
}

}  // namespace velamap
