#include "importer/video/ffmpeg_picture.h"

#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <string_view>

extern "C" {
#include <libavcodec/avcodec.h>
}

#include "importer/video/video_picture.h"
#include "importer/video/video_stream.h"

namespace velamap {
namespace {

struct Signature {
  std::string_view bytes;
  AVCodecID codec;
};

// The first bytes of each file format. Each decoder takes a whole file as one packet, and refuses a
// RIFF file that is not WebP.
constexpr Signature kSignatures[] = {
    {"\x89PNG", AV_CODEC_ID_PNG},
    {"\xFF\xD8", AV_CODEC_ID_MJPEG},
    {{"II*\0", 4}, AV_CODEC_ID_TIFF},
    {{"MM\0*", 4}, AV_CODEC_ID_TIFF},
    {"BM", AV_CODEC_ID_BMP},
    {"RIFF", AV_CODEC_ID_WEBP},
    {{"\0\0\0\x0CjP  ", 8}, AV_CODEC_ID_JPEG2000},
    {"\xFF\x4F\xFF\x51", AV_CODEC_ID_JPEG2000},
    {"P1", AV_CODEC_ID_PBM},
    {"P2", AV_CODEC_ID_PGM},
    {"P3", AV_CODEC_ID_PPM},
    {"P4", AV_CODEC_ID_PBM},
    {"P5", AV_CODEC_ID_PGM},
    {"P6", AV_CODEC_ID_PPM},
    {"\x59\xA6\x6A\x95", AV_CODEC_ID_SUNRAST},
    {"\x76\x2F\x31\x01", AV_CODEC_ID_EXR},
};

// Null for other files.
const AVCodec* FindDecoder(const std::vector<std::uint8_t>& bytes) {
  const std::string_view file(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const Signature& signature : kSignatures) {
    if (file.substr(0, signature.bytes.size()) == signature.bytes) {
      return avcodec_find_decoder(signature.codec);
    }
  }
  return nullptr;
}

}  // namespace

cv::Mat DecodeWithFfmpeg(const std::vector<std::uint8_t>& bytes) {
  av_log_set_callback(NoteLoggedDamage);
  PacketDamage damage;  // outlives the codec, which writes to it
  const AVCodec* decoder = FindDecoder(bytes);
  if (decoder == nullptr || bytes.size() > std::numeric_limits<int>::max()) return {};
  const std::unique_ptr<AVCodecContext, FfmpegFreer> codec(avcodec_alloc_context3(decoder));
  const std::unique_ptr<AVPacket, FfmpegFreer> packet(av_packet_alloc());
  const std::unique_ptr<AVFrame, FfmpegFreer> frame(av_frame_alloc());
  if (codec == nullptr || packet == nullptr || frame == nullptr ||
      av_new_packet(packet.get(), static_cast<int>(bytes.size())) < 0) {
    throw std::bad_alloc();
  }
  std::memcpy(packet->data, bytes.data(), bytes.size());
  codec->thread_count = 1;
  codec->opaque = &damage;
  codec->reordered_opaque = damage.Add(VideoPacket::kNoTime, true);
  if (avcodec_open2(codec.get(), decoder, nullptr) < 0 ||
      avcodec_send_packet(codec.get(), packet.get()) < 0 ||
      avcodec_send_packet(codec.get(), nullptr) < 0 ||
      avcodec_receive_frame(codec.get(), frame.get()) < 0) {
    return {};
  }
  return damage.IsWhole(codec->reordered_opaque) ? VideoPicture(*frame).Color() : cv::Mat();
}

}  // namespace velamap
