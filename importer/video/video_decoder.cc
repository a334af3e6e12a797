#include "importer/video/video_decoder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <new>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
}

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/video/video_seek.h"

namespace velamap {
namespace {

// After so many failures in a row the rest of the file is taken as broken.
constexpr int kMaxNumFailures = 4096;

struct FfmpegFreer {
  void operator()(AVFormatContext* format) const { avformat_close_input(&format); }
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
using FormatPtr = std::unique_ptr<AVFormatContext, FfmpegFreer>;

[[noreturn]] void ThrowUnreadable(const std::string& path) {
  throw InputError(
      fmt::format("{}: not a readable video, or cut off before its index; give a folder of images "
                  "or a whole video file",
                  path));
}

// FFmpeg shows any text as a film of letters ("tty"), and follows lists of other files, whose
// changes nobody would notice.
void CheckHoldsPictures(const std::string& path, const std::string& format) {
  static constexpr const char* kOthers[] = {"tty", "concat", "hls", "dash", "imf", "sdp"};
  if (std::none_of(std::begin(kOthers), std::end(kOthers),
                   [&](const char* other) { return format == other; })) {
    return;
  }
  throw InputError(
      fmt::format("{}: is a text or a list of other files (FFmpeg's format {}); give "
                  "the video itself",
                  path, format));
}

FormatPtr OpenFormat(const std::string& path) {
  AVFormatContext* opened = nullptr;
  // Without the protocol, FFmpeg would look for one before a colon in the name.
  if (avformat_open_input(&opened, ("file:" + path).c_str(), nullptr, nullptr) < 0) {
    ThrowUnreadable(path);
  }
  FormatPtr format(opened);
  CheckHoldsPictures(path, opened->iformat->name);
  if (avformat_find_stream_info(opened, nullptr) < 0) ThrowUnreadable(path);
  return format;
}

// Chooses the first video stream that is no cover picture; the other streams are not read.
AVStream* ChooseVideoStream(const std::string& path, AVFormatContext* format) {
  AVStream* chosen = nullptr;
  for (unsigned i = 0; i < format->nb_streams; ++i) {
    AVStream* stream = format->streams[i];
    const bool is_video = stream->codecpar->codec_type == AVMEDIA_TYPE_VIDEO &&
                          (stream->disposition & AV_DISPOSITION_ATTACHED_PIC) == 0;
    if (is_video && chosen == nullptr) {
      chosen = stream;
    } else {
      stream->discard = AVDISCARD_ALL;
    }
  }
  if (chosen == nullptr) ThrowUnreadable(path);
  return chosen;
}

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

// The state of FFmpeg for one pass over the file.
class VideoDecoder::Stream {
 public:
  explicit Stream(const std::string& path)
      : format_(OpenFormat(path)),
        stream_(ChooseVideoStream(path, format_.get())),
        packet_(av_packet_alloc()),
        frame_(av_frame_alloc()) {
    if (packet_ == nullptr || frame_ == nullptr) throw std::bad_alloc();
  }

  void OpenCodec(const std::string& path, int num_threads) {
    const AVCodec* decoder = avcodec_find_decoder(stream_->codecpar->codec_id);
    if (decoder == nullptr) ThrowUnreadable(path);
    // FFmpeg opens no decoder at all if the system refuses one of its threads.
    for (const int count : {num_threads, 1}) {
      codec_.reset(avcodec_alloc_context3(decoder));
      if (codec_ == nullptr) throw std::bad_alloc();
      if (avcodec_parameters_to_context(codec_.get(), stream_->codecpar) < 0) break;
      codec_->pkt_timebase = stream_->time_base;
      codec_->thread_count = count;
      if (avcodec_open2(codec_.get(), decoder, nullptr) >= 0) return;
    }
    ThrowUnreadable(path);
  }

  const AVStream& stream() const { return *stream_; }
  const AVFrame& frame() const { return *frame_; }

  double FramesPerSecond() const {
    const AVRational rate = av_guess_frame_rate(format_.get(), stream_, nullptr);
    return rate.num > 0 && rate.den > 0 ? av_q2d(rate) : 0.0;
  }

  // Angles between quarters are left alone, as in cv::VideoCapture.
  int NumQuarterTurns() const {
    const std::uint8_t* matrix =
        av_stream_get_side_data(stream_, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
    if (matrix == nullptr) return 0;
    const double clockwise_deg =
        -av_display_rotation_get(reinterpret_cast<const std::int32_t*>(matrix));
    const long rounded_deg = std::isfinite(clockwise_deg) ? std::lround(clockwise_deg) : 0;
    return rounded_deg % 90 == 0 ? static_cast<int>((rounded_deg / 90 + 4) % 4) : 0;
  }

  double DurationSeconds() const {
    if (stream_->duration != AV_NOPTS_VALUE) return stream_->duration * av_q2d(stream_->time_base);
    if (format_->duration != AV_NOPTS_VALUE)
      return static_cast<double>(format_->duration) / AV_TIME_BASE;
    return 0.0;
  }

  // Lists the first packets of the video without decoding. Empty if one is damaged.
  std::vector<VideoPacket> ListPackets(std::size_t max_num_packets) {
    std::vector<VideoPacket> packets;
    while (packets.size() < max_num_packets && ReadPacket()) {
      if ((packet_->flags & AV_PKT_FLAG_CORRUPT) != 0) return {};
      const auto time = [](std::int64_t value) {
        return value == AV_NOPTS_VALUE ? VideoPacket::kNoTime : value;
      };
      packets.push_back({time(packet_->pts), (packet_->flags & AV_PKT_FLAG_KEY) != 0,
                         (packet_->flags & AV_PKT_FLAG_DISCARD) == 0, time(packet_->dts)});
    }
    return packets;
  }

  // Decodes the frame at `point`. Returns false if the container or the decoder arrives elsewhere.
  bool SeekTo(const SeekPoint& point) {
    // Some containers search by time of decoding, some by time of presentation. The former is the
    // earlier one and serves both.
    if (!point.is_start && av_seek_frame(format_.get(), stream_->index, point.key_decode_time,
                                         AVSEEK_FLAG_BACKWARD) < 0) {
      return false;
    }
    do {
      if (!ReadPacket()) return false;
    } while (packet_->pts != point.key_time || (packet_->flags & AV_PKT_FLAG_KEY) == 0);
    avcodec_send_packet(codec_.get(), packet_.get());
    skip_before_time_ = point.skip_before_time;
    // The skipped frames include pictures that are shown before the key frame but stored after it;
    // their references are missing.
    do {
      if (!Decode()) return false;
    } while (frame_->pts != AV_NOPTS_VALUE && frame_->pts < point.time);
    return frame_->pts == point.time;
  }

  // Decodes the next frame in order of presentation. Returns false at the end.
  bool Decode() {
    for (int num_failures = 0; num_failures < kMaxNumFailures;) {
      const int result = avcodec_receive_frame(codec_.get(), frame_.get());
      if (result == 0) return true;
      if (result == AVERROR_EOF) return false;
      if (result == AVERROR(EAGAIN)) {
        // At the end of the file a null packet makes the decoder return the frames that it holds.
        AVPacket* packet = ReadPacket() ? packet_.get() : nullptr;
        const bool is_unwanted = packet != nullptr && packet->pts < skip_before_time_;
        codec_->skip_frame = is_unwanted ? AVDISCARD_NONREF : AVDISCARD_DEFAULT;
        num_failures += avcodec_send_packet(codec_.get(), packet) < 0;
      } else {
        ++num_failures;
      }
    }
    return false;
  }

 private:
  // Returns false at the end and at a read error.
  bool ReadPacket() {
    int result = 0;
    do {
      av_packet_unref(packet_.get());
      result = av_read_frame(format_.get(), packet_.get());
    } while (result == AVERROR(EAGAIN) || (result == 0 && packet_->stream_index != stream_->index));
    return result == 0;
  }

  FormatPtr format_;
  AVStream* stream_;
  std::unique_ptr<AVCodecContext, FfmpegFreer> codec_;
  std::unique_ptr<AVPacket, FfmpegFreer> packet_;
  std::unique_ptr<AVFrame, FfmpegFreer> frame_;
  std::int64_t skip_before_time_ = std::numeric_limits<std::int64_t>::min();
};

VideoDecoder::VideoDecoder(const std::string& path, int num_threads)
    : path_(path), num_threads_(num_threads) {
  VELAMAP_CHECK(num_threads >= 0);
  // FFmpeg would print lines of its own about a broken file.
  av_log_set_level(AV_LOG_QUIET);
  stream_ = std::make_unique<Stream>(path_);
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
          : std::floor(stream_->DurationSeconds() * stream_->FramesPerSecond() + 0.5);
  return count > 0 && count < 1e9 ? static_cast<int>(count) : 0;
}

void VideoDecoder::SkipTo(int number) {
  VELAMAP_CHECK(next_number_ == 0 && !has_frame_ && number >= 0);
  if (number == 0 || !CanCountPackets(*stream_->stream().codecpar)) return;
  const auto max_num_packets = static_cast<std::size_t>(number) + 1 + 2 * kMaxReorder;
  const std::vector<VideoPacket> packets = Stream(path_).ListPackets(max_num_packets);
  const std::optional<SeekPoint> point = FindSeekPoint(packets, number);
  if (!point) return;
  if (stream_->SeekTo(*point)) {
    next_number_ = point->frame_number;
    has_frame_ = true;
  } else {
    stream_ = std::make_unique<Stream>(path_);
    stream_->OpenCodec(path_, num_threads_);
  }
}

std::optional<VideoFrame> VideoDecoder::Next() {
  if (!has_frame_ && !stream_->Decode()) return std::nullopt;
  has_frame_ = false;
  const AVFrame& frame = stream_->frame();
  const AVStream& stream = stream_->stream();
  VideoFrame result{next_number_++, std::nullopt, VideoPicture(frame, num_quarter_turns_)};
  const double frames_per_second = stream_->FramesPerSecond();
  if (frame.pts != AV_NOPTS_VALUE) {
    const std::int64_t start = stream.start_time == AV_NOPTS_VALUE ? 0 : stream.start_time;
    const double time_s = static_cast<double>(frame.pts - start) * av_q2d(stream.time_base);
    result.time_s = CountOn(time_s, frames_per_second);
  } else if (frames_per_second > 0) {
    result.time_s = CountOn(result.number / frames_per_second, frames_per_second);
  }
  return result;
}

double VideoDecoder::CountOn(double time_s, double frames_per_second) {
  constexpr double kUnknownPeriod_s = 0.04;
  if (last_time_s_ && time_s + time_offset_s_ < *last_time_s_) {
    const double period_s = frames_per_second > 0 ? 1.0 / frames_per_second : kUnknownPeriod_s;
    time_offset_s_ = *last_time_s_ + period_s - time_s;
  }
  last_time_s_ = time_s + time_offset_s_;
  return *last_time_s_;
}

int VideoDecoder::NumFramesRead() const { return next_number_; }

}  // namespace velamap
