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

// The key frame to begin at and the frame to come to.
struct SeekPoint {
  std::int64_t key_time = 0;         // of presentation
  std::int64_t key_decode_time = 0;  // its time of presentation where this is not known
  bool is_start = false;             // the key frame is the first packet
  std::int64_t time = 0;             // of presentation of the frame
  int frame_number = 0;              // of the frame: how many frames are shown before it
  // Pictures shown before this time that no other refers to need not be decoded.
  std::int64_t skip_before_time = 0;
};

// No codec lets more pictures than this be decoded before one that is shown earlier (H.264, H.265).
inline constexpr std::size_t kMaxReorder = 16;

// How to come to frame `frame_number`, or to the last frame if there are fewer, from the last key
// frame that allows it. `packets` begin with the video and go at least 2 kMaxReorder past that
// frame, or to the end.
//
// At the end of a file FFmpeg's decoder of H.264 throws away what follows a key frame in the middle
// of a stream that it has not handed out by then. So a key frame with fewer than kMaxReorder
// packets behind it is not taken, and as many frames before the wanted one are decoded in any case.
//
// Nothing if the frame can only be counted by decoding: a packet without a time or with the time of
// another, or pictures shown before the first key frame, which the decoder may leave out.
std::optional<SeekPoint> FindSeekPoint(const std::vector<VideoPacket>& packets, int frame_number);

}  // namespace velamap
