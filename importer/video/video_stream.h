// FFmpeg's state for one pass over a video file. video_decoder.h counts its frames.

#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include "importer/packets/packet_damage.h"
#include "importer/packets/video_seek.h"

namespace velamap {

struct FfmpegFreer {
  void operator()(AVFormatContext* format) const { avformat_close_input(&format); }
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};

// A callback for av_log_set_callback() that prints nothing. It marks the packet that a decoder
// reports as damaged, if the decoder's `opaque` is a PacketDamage and its `reordered_opaque` the
// number of the packet. There is no other way to learn of damaged frames: FFmpeg's decoders conceal
// damage, and with several threads they lose the flags that report it.
void NoteLoggedDamage(void* context, int level, const char* format, va_list arguments);

// Throws std::bad_alloc where FFmpeg runs out of memory, which must not pass for the end of the
// video.
class VideoStream {
 public:
  // Throws InputError if FFmpeg cannot read the file, or if it holds no video.
  explicit VideoStream(const std::string& path);

  // Throws InputError if there is no decoder.
  void OpenCodec(const std::string& path, int num_threads);

  const AVStream& stream() const { return *stream_; }
  const AVFrame& frame() const { return *frame_; }

  // FFmpeg's guess of the frame rate; 0 if unknown. If the rate varies, all gaps between frames are
  // multiples of the inverse of the guess.
  double FramesPerSecond() const;
  double MeanFramesPerSecond() const;  // as the container states it; 0 if it does not
  double DurationSeconds() const;      // 0 if unknown
  double PixelAspect() const;          // width over height of a pixel; 1 if unknown
  int NumQuarterTurns() const;         // clockwise, as the metadata say

  // Lists the first packets of the video without decoding. Empty if one is damaged.
  std::vector<VideoPacket> ListPackets(std::size_t max_num_packets);

  // Decodes the frame at `point`. Returns false if the container or the decoder arrives elsewhere.
  bool SeekTo(const SeekPoint& point);

  // Decodes the next frame in order of presentation. Returns false at the end.
  bool Decode();

  // Whether the frame that was decoded last shows what was recorded.
  bool IsWhole() const;

 private:
  // Returns false at the end and at a read error.
  bool ReadPacket();

  // A null packet ends the video.
  int SendPacket(AVPacket* packet);

  PacketDamage damage_;  // outlives the codec, whose threads write to it
  std::unique_ptr<AVFormatContext, FfmpegFreer> format_;
  AVStream* stream_;
  std::unique_ptr<AVCodecContext, FfmpegFreer> codec_;
  std::unique_ptr<AVPacket, FfmpegFreer> packet_;
  std::unique_ptr<AVFrame, FfmpegFreer> frame_;
  std::int64_t skip_before_time_ = std::numeric_limits<std::int64_t>::min();
};

}  // namespace velamap
