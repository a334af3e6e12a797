#include "importer/video/ffmpeg_picture.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <utility>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include "importer/video/video_picture.h"

namespace velamap {
namespace {

// By the name of FFmpeg's demuxer. Each decoder takes a whole file as one packet.
constexpr std::pair<const char*, AVCodecID> kPictureCodecs[] = {
    {"png_pipe", AV_CODEC_ID_PNG},         {"tiff_pipe", AV_CODEC_ID_TIFF},
    {"bmp_pipe", AV_CODEC_ID_BMP},         {"webp_pipe", AV_CODEC_ID_WEBP},
    {"j2k_pipe", AV_CODEC_ID_JPEG2000},    {"pgm_pipe", AV_CODEC_ID_PGM},
    {"ppm_pipe", AV_CODEC_ID_PPM},         {"pbm_pipe", AV_CODEC_ID_PBM},
    {"sunrast_pipe", AV_CODEC_ID_SUNRAST}, {"exr_pipe", AV_CODEC_ID_EXR},
};

// Looks at the first bytes only.
const AVCodec* FindDecoder(const std::vector<std::uint8_t>& bytes) {
  // FFmpeg would take a JPEG for a film of one picture.
  if (bytes.size() > 2 && bytes[0] == 0xFF && bytes[1] == 0xD8) {
    return avcodec_find_decoder(AV_CODEC_ID_MJPEG);
  }
  std::vector<std::uint8_t> head(
      bytes.begin(),
      bytes.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(bytes.size(), 4096)));
  AVProbeData probe = {};
  probe.filename = "";
  probe.buf_size = static_cast<int>(head.size());
  head.resize(head.size() + AVPROBE_PADDING_SIZE);
  probe.buf = head.data();
  const AVInputFormat* format = av_probe_input_format(&probe, 1);
  if (format == nullptr) return nullptr;
  for (const auto& [name, codec] : kPictureCodecs) {
    if (std::strcmp(format->name, name) == 0) return avcodec_find_decoder(codec);
  }
  return nullptr;
}

}  // namespace

cv::Mat DecodeWithFfmpeg(const std::vector<std::uint8_t>& bytes) {
  av_log_set_level(AV_LOG_QUIET);  // it would print lines of its own about a broken file
  const AVCodec* decoder = FindDecoder(bytes);
  if (decoder == nullptr || bytes.size() > std::numeric_limits<int>::max()) return {};
  const auto codec = std::unique_ptr<AVCodecContext, void (*)(AVCodecContext*)>(
      avcodec_alloc_context3(decoder), [](AVCodecContext* owned) { avcodec_free_context(&owned); });
  const auto packet = std::unique_ptr<AVPacket, void (*)(AVPacket*)>(
      av_packet_alloc(), [](AVPacket* owned) { av_packet_free(&owned); });
  const auto frame = std::unique_ptr<AVFrame, void (*)(AVFrame*)>(
      av_frame_alloc(), [](AVFrame* owned) { av_frame_free(&owned); });
  if (codec == nullptr || packet == nullptr || frame == nullptr ||
      av_new_packet(packet.get(), static_cast<int>(bytes.size())) < 0) {
    throw std::bad_alloc();
  }
  std::memcpy(packet->data, bytes.data(), bytes.size());
  codec->thread_count = 1;
  if (avcodec_open2(codec.get(), decoder, nullptr) < 0 ||
      avcodec_send_packet(codec.get(), packet.get()) < 0 ||
      avcodec_send_packet(codec.get(), nullptr) < 0 ||
      avcodec_receive_frame(codec.get(), frame.get()) < 0) {
    return {};
  }
  return VideoPicture(*frame).Color();
}

}  // namespace velamap
