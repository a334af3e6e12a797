#include "importer/video/video_decoder.h"

#include <cmath>
#include <cstdint>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include "importer/base/error.h"
#include "importer/packets/video_seek.h"
#include "importer/video/video_stream.h"

namespace velamap {
namespace {

// Whether every packet of the codec is one frame. VP8, VP9 and AV1 have packets without a shown
// frame, MPEG-4 part 2 leaves frames out, and interlaced video may have one field a packet.
bool CanCountPackets(const AVCodecParameters& parameters) {
  switch (parameters.codec_id) {
    case AV_CODEC_ID_H264:
    case AV_CODEC_ID_HEVC:
    case AV_CODEC_ID_MJPEG:
    case AV_CODEC_ID_PRORES:
      return parameters.field_order == AV_FIELD_UNKNOWN ||
             parameters.field_order == AV_FIELD_PROGRESSIVE;
    default:
      return false;
  }
}

}  // namespace

VideoDecoder::VideoDecoder(const std::string& path, int num_threads)
    : path_(path), num_threads_(num_threads) {
  VELAMAP_CHECK(num_threads >= 0);
  stream_ = std::make_unique<VideoStream>(path_);
  stream_->OpenCodec(path_, num_threads_);
  num_quarter_turns_ = stream_->NumQuarterTurns();
}

VideoDecoder::~VideoDecoder() = default;

int VideoDecoder::NumQuarterTurns() const { return num_quarter_turns_; }

bool VideoDecoder::IsMarkedInterlaced() const {
  const AVFieldOrder order = stream_->stream().codecpar->field_order;
  return order != AV_FIELD_UNKNOWN && order != AV_FIELD_PROGRESSIVE;
}

int VideoDecoder::NumContainerFrames() const {
  const double count =
      stream_->stream().nb_frames > 0
          ? static_cast<double>(stream_->stream().nb_frames)
          : std::floor(stream_->DurationSeconds() * stream_->MeanFramesPerSecond() + 0.5);
  return count > 0 && count < 1e9 ? static_cast<int>(count) : 0;
}

void VideoDecoder::SkipTo(int number) {
  VELAMAP_CHECK(next_number_ == 0 && !has_frame_ && number >= 0);
  if (number == 0 || !CanCountPackets(*stream_->stream().codecpar)) return;
  const auto max_num_packets = static_cast<std::size_t>(number) + 1 + 2 * kMaxReorder;
  const std::vector<VideoPacket> packets = VideoStream(path_).ListPackets(max_num_packets);
  const std::optional<SeekPoint> point = FindSeekPoint(packets, number);
  if (!point) return;
  if (stream_->SeekTo(*point)) {
    next_number_ = point->frame_number;
    has_frame_ = true;
  } else {
    stream_ = std::make_unique<VideoStream>(path_);
    stream_->OpenCodec(path_, num_threads_);
  }
}

std::optional<VideoFrame> VideoDecoder::Next() {
  if (!has_frame_ && !stream_->Decode()) return std::nullopt;
  has_frame_ = false;
  const AVFrame& frame = stream_->frame();
  const AVStream& stream = stream_->stream();
  VideoFrame result{next_number_++, std::nullopt, VideoPicture(frame, num_quarter_turns_),
                    stream_->IsWhole()};
  const double frames_per_second = stream_->FramesPerSecond();
  if (frame.pts != AV_NOPTS_VALUE) {
    const std::int64_t start = stream.start_time == AV_NOPTS_VALUE ? 0 : stream.start_time;
    const double time_s = static_cast<double>(frame.pts - start) * av_q2d(stream.time_base);
    result.time_s = TimeInOrder(time_s, frames_per_second);
  } else if (frames_per_second > 0) {
    result.time_s = TimeInOrder(result.number / frames_per_second, frames_per_second);
  }
  return result;
}

double VideoDecoder::TimeInOrder(double time_s, double frames_per_second) {
  constexpr double kUnknownPeriod_s = 0.04;
  if (last_time_s_ && time_s + time_offset_s_ < *last_time_s_) {
    const double period_s = frames_per_second > 0 ? 1.0 / frames_per_second : kUnknownPeriod_s;
    time_offset_s_ = *last_time_s_ + period_s - time_s;
  }
  last_time_s_ = time_s + time_offset_s_;
  return *last_time_s_;
}

}  // namespace velamap
