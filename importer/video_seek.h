// Where to begin decoding so that a frame is reached without all that lie before it, told from the
// packets of a video alone.

#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace velamap {

// One compressed picture, in the order of the file, which is the order of decoding.
struct VideoPacket {
  static constexpr std::int64_t kNoTime = std::numeric_limits<std::int64_t>::min();

  std::int64_t time = kNoTime;         // of presentation, in units of the stream
  bool is_key = false;                 // decoding can begin here
  bool is_shown = true;                // false: cut away by the container's edit list
  std::int64_t decode_time = kNoTime;  // of decoding; not later than `time`
};

struct SeekPoint {
  std::int64_t time = 0;         // of presentation of the key frame
  std::int64_t decode_time = 0;  // of the same; its time of presentation where it is not known
  int frame_number = 0;          // of the key frame: how many frames are shown before it
};

// No codec lets more pictures than this be decoded before one that is shown earlier (H.264, H.265).
inline constexpr std::size_t kMaxReorder = 16;

// The last key frame from which frame `frame_number` can be decoded; for a frame behind the end,
// the last from which the end can. `packets` begin with the video and go at least 2 kMaxReorder
// past that frame, or to the end. A key frame with fewer than kMaxReorder packets behind it is not
// taken: at the end of the file FFmpeg's decoder of H.264 throws away what follows a key frame in
// the middle of a stream if it has not come to hand that out by then.
//
// Nothing if the frame can only be counted by decoding: no such key frame but the first, a packet
// without a time or with the time of another, or pictures shown before the first key frame, which
// the decoder may leave out.
std::optional<SeekPoint> FindSeekPoint(const std::vector<VideoPacket>& packets, int frame_number);

}  // namespace velamap
