#include "importer/video/video_stream.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdarg>
#include <cstring>
#include <iterator>
#include <new>
#include <string_view>

extern "C" {
#include <libavutil/display.h>
}

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

static_assert(VideoPacket::kNoTime == AV_NOPTS_VALUE);

using FormatPtr = std::unique_ptr<AVFormatContext, FfmpegFreer>;

// After this many failures in a row, the rest of the file is considered broken.
constexpr int kMaxNumFailures = 4096;

[[noreturn]] void ThrowUnreadable(const std::string& path) {
  throw InputError(
      fmt::format("{}: not a readable video, or cut off before its index; give a folder of images "
                  "or a whole video file",
                  path));
}

// FFmpeg takes a photograph for a video of one frame ("jpeg_pipe"), shows any text as a film of
// letters ("tty"), and follows lists of other files, whose changes nobody would notice.
void CheckHoldsVideo(const std::string& path, const std::string& format) {
  constexpr std::string_view kPicture = "_pipe";
  if (format.size() > kPicture.size() &&
      format.compare(format.size() - kPicture.size(), kPicture.size(), kPicture) == 0) {
    throw InputError(
        fmt::format("{}: is a picture (FFmpeg's format {}), not a video; rename it with the "
                    "extension of its format, such as .jpg, and give the folder that holds it",
                    path, format));
  }
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

// Messages that FFmpeg logs as errors although every pixel is right: missing references that were
// to be dropped (cut videos and some cameras), and metadata of the picture.
bool IsHarmless(const char* message) {
  static constexpr const char* kHarmless[] = {"mmco", "SEI", "APP fields", "VUI", "timecode"};
  return std::any_of(std::begin(kHarmless), std::end(kHarmless),
                     [&](const char* words) { return std::strstr(message, words) != nullptr; });
}

FormatPtr OpenFormat(const std::string& path) {
  // By default FFmpeg would print lines of its own about a broken file.
  av_log_set_callback(NoteLoggedDamage);
  AVFormatContext* opened = nullptr;
  // Without the protocol, FFmpeg would look for one before a colon in the name.
  const int error = avformat_open_input(&opened, ("file:" + path).c_str(), nullptr, nullptr);
  if (error == AVERROR(EACCES)) {
    throw InputError(
        path +
        ": no permission to read this file; change its permissions, or copy it to a folder "
        "of your own");
  }
  if (error < 0) ThrowUnreadable(path);
  FormatPtr format(opened);
  CheckHoldsVideo(path, opened->iformat->name);
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

// FFmpeg writes 0/1 or 0/0 for an unknown value.
double ValueOr(const AVRational& ratio, double unknown) {
  return ratio.num > 0 && ratio.den > 0 ? av_q2d(ratio) : unknown;
}

int Checked(int result) {
  if (result == AVERROR(ENOMEM)) throw std::bad_alloc();
  return result;
}

}  // namespace

void NoteLoggedDamage(void* context, int level, const char* format, va_list /*arguments*/) {
  if (context == nullptr) return;
  const bool is_damage =
      (level <= AV_LOG_ERROR && !IsHarmless(format)) || std::strncmp(format, "concealing", 10) == 0;
  const AVClass* kind = *static_cast<const AVClass**>(context);
  if (!is_damage || kind == nullptr || kind != avcodec_get_class()) return;
  const auto* codec = static_cast<const AVCodecContext*>(context);
  // Set for the decoders of this file only.
  if (auto* damage = static_cast<PacketDamage*>(codec->opaque)) {
    damage->Mark(codec->reordered_opaque);
  }
}

VideoStream::VideoStream(const std::string& path)
    : format_(OpenFormat(path)),
      stream_(ChooseVideoStream(path, format_.get())),
      packet_(av_packet_alloc()),
      frame_(av_frame_alloc()) {
  if (packet_ == nullptr || frame_ == nullptr) throw std::bad_alloc();
}

void VideoStream::OpenCodec(const std::string& path, int num_threads) {
  const AVCodec* decoder = avcodec_find_decoder(stream_->codecpar->codec_id);
  if (decoder == nullptr) ThrowUnreadable(path);
  // FFmpeg opens no decoder at all if the system refuses one of its threads.
  for (const int count : {num_threads, 1}) {
    codec_.reset(avcodec_alloc_context3(decoder));
    if (codec_ == nullptr) throw std::bad_alloc();
    if (avcodec_parameters_to_context(codec_.get(), stream_->codecpar) < 0) break;
    codec_->pkt_timebase = stream_->time_base;
    codec_->thread_count = count;
    codec_->err_recognition |= AV_EF_CRCCHECK;
    codec_->opaque = &damage_;
    if (avcodec_open2(codec_.get(), decoder, nullptr) >= 0) return;
  }
  ThrowUnreadable(path);
}

double VideoStream::FramesPerSecond() const {
  return ValueOr(av_guess_frame_rate(format_.get(), stream_, nullptr), 0.0);
}

double VideoStream::MeanFramesPerSecond() const { return ValueOr(stream_->avg_frame_rate, 0.0); }

double VideoStream::PixelAspect() const {
  return ValueOr(av_guess_sample_aspect_ratio(format_.get(), stream_, nullptr), 1.0);
}

// Ignores angles that are not multiples of 90 degrees, as cv::VideoCapture does.
int VideoStream::NumQuarterTurns() const {
  const std::uint8_t* matrix = av_stream_get_side_data(stream_, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
  if (matrix == nullptr) return 0;
  const double clockwise_deg =
      -av_display_rotation_get(reinterpret_cast<const std::int32_t*>(matrix));
  const long rounded_deg = std::isfinite(clockwise_deg) ? std::lround(clockwise_deg) : 0;
  return rounded_deg % 90 == 0 ? static_cast<int>((rounded_deg / 90 + 4) % 4) : 0;
}

double VideoStream::DurationSeconds() const {
  if (stream_->duration != AV_NOPTS_VALUE) return stream_->duration * av_q2d(stream_->time_base);
  if (format_->duration != AV_NOPTS_VALUE)
    return static_cast<double>(format_->duration) / AV_TIME_BASE;
  return 0.0;
}

std::vector<VideoPacket> VideoStream::ListPackets(std::size_t max_num_packets) {
  std::vector<VideoPacket> packets;
  while (packets.size() < max_num_packets && ReadPacket()) {
    if ((packet_->flags & AV_PKT_FLAG_CORRUPT) != 0) return {};
    packets.push_back({packet_->pts, (packet_->flags & AV_PKT_FLAG_KEY) != 0,
                       (packet_->flags & AV_PKT_FLAG_DISCARD) == 0, packet_->dts});
  }
  return packets;
}

bool VideoStream::SeekTo(const SeekPoint& point) {
  // Some containers search by time of decoding, some by time of presentation. The former is the
  // earlier one and serves both.
  if (!point.is_start && av_seek_frame(format_.get(), stream_->index, point.key_decode_time,
                                       AVSEEK_FLAG_BACKWARD) < 0) {
    return false;
  }
  do {
    if (!ReadPacket()) return false;
  } while (packet_->pts != point.key_time || (packet_->flags & AV_PKT_FLAG_KEY) == 0);
  SendPacket(packet_.get());
  skip_before_time_ = point.skip_before_time;
  // The skipped frames include pictures that are shown before the key frame but stored after it;
  // their references are missing.
  do {
    if (!Decode()) return false;
  } while (frame_->pts != AV_NOPTS_VALUE && frame_->pts < point.time);
  return frame_->pts == point.time;
}

bool VideoStream::Decode() {
  for (int num_failures = 0; num_failures < kMaxNumFailures;) {
    const int result = Checked(avcodec_receive_frame(codec_.get(), frame_.get()));
    if (result == 0) return true;
    if (result == AVERROR_EOF) return false;
    if (result == AVERROR(EAGAIN)) {
      // At the end of the file a null packet makes the decoder return the frames that it holds.
      AVPacket* packet = ReadPacket() ? packet_.get() : nullptr;
      const bool is_unwanted = packet != nullptr && packet->pts < skip_before_time_;
      codec_->skip_frame = is_unwanted ? AVDISCARD_NONREF : AVDISCARD_DEFAULT;
      num_failures += SendPacket(packet) < 0;
    } else {
      ++num_failures;
    }
  }
  return false;
}

bool VideoStream::IsWhole() const {
  const bool is_marked =
      (frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame_->decode_error_flags != 0;
  return !is_marked && damage_.IsWhole(frame_->reordered_opaque);
}

bool VideoStream::ReadPacket() {
  int result = 0, num_failures = 0;
  do {
    av_packet_unref(packet_.get());
    result = Checked(av_read_frame(format_.get(), packet_.get()));
    // The bytes between two packets may be damaged as well.
    num_failures += result == AVERROR_INVALIDDATA;
  } while (result == AVERROR(EAGAIN) ||
           (result == AVERROR_INVALIDDATA && num_failures < kMaxNumFailures) ||
           (result == 0 && packet_->stream_index != stream_->index));
  return result == 0;
}

int VideoStream::SendPacket(AVPacket* packet) {
  if (packet != nullptr) {
    codec_->reordered_opaque = damage_.Add(packet->pts, (packet->flags & AV_PKT_FLAG_KEY) != 0);
    if ((packet->flags & AV_PKT_FLAG_CORRUPT) != 0) damage_.Mark(codec_->reordered_opaque);
  }
  return Checked(avcodec_send_packet(codec_.get(), packet));
}

}  // namespace velamap
