// Finds where to begin decoding so that a frame is reached without decoding all earlier frames. The
// packets of the video suffice for this.

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
  bool is_shown = true;                // false: removed by the container's edit list
  std::int64_t decode_time = kNoTime;  // of decoding; not later than `time`
};

// The key frame at which to begin and the frame to reach.
struct SeekPoint {
  std::int64_t key_time = 0;         // of presentation
  std::int64_t key_decode_time = 0;  // the time of presentation if this is unknown
  bool is_start = false;             // whether the key frame is the first packet
  std::int64_t time = 0;             // of presentation of the frame
  int frame_number = 0;              // the number of frames that are shown before the frame
  // Pictures that are shown before this time and that no other picture refers to can be skipped.
  std::int64_t skip_before_time = 0;
};

// H.264 and H.265 let at most this many pictures be decoded before one that is shown earlier.
inline constexpr std::size_t kMaxReorder = 16;

// Finds the last key frame from which frame `frame_number`, or the last frame if there are fewer,
// can be reached. `packets` begin with the video and reach at least 2 kMaxReorder past that frame,
// or to the end.
//
// When decoding has begun at a key frame in the middle of a stream, FFmpeg's decoder of H.264
// discards the frames that it still holds at the end of the file. A key frame with fewer than
// kMaxReorder packets after it is therefore not used, and at least as many frames before the wanted
// one are decoded.
//
// Returns nothing if frames can only be counted by decoding them: if a packet has no presentation
// time or the same as another one, if decoding times run backwards, or if pictures are shown before
// the first key frame, because the decoder may leave these out.
std::optional<SeekPoint> FindSeekPoint(const std::vector<VideoPacket>& packets, int frame_number);

}  // namespace velamap
