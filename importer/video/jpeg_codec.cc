#include "importer/video/jpeg_codec.h"

#include <algorithm>
#include <cstdio>
#include <memory>

#include <turbojpeg.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

using Codec = std::unique_ptr<void, int (*)(tjhandle)>;

Codec MakeCodec(tjhandle handle) {
  VELAMAP_CHECK(handle != nullptr);
  return {handle, tjDestroy};
}

// `compress` is given the addresses of a buffer, which it allocates, and of its size.
template <typename Compress>
std::string Encode(const Compress& compress) {
  const Codec encoder = MakeCodec(tjInitCompress());
  unsigned char* data = nullptr;
  unsigned long size = 0;
  const int failed = compress(encoder.get(), &data, &size);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(data, tjFree);
  VELAMAP_CHECK(failed == 0);
  return {reinterpret_cast<const char*>(data), size};
}

// libjpeg-turbo's warning about data that remain before the end-of-image marker. It reports only
// its first warning, so everything before these data was right. Wrong bits cause this warning, and
// so do cameras that write something after the image data.
struct Remainder {
  bool exists = false;
  bool is_padding = false;  // a byte, or zeros and FF: no compressed data end like that
};

Remainder RemainderOf(const std::string& warning, const std::vector<std::uint8_t>& bytes) {
  unsigned num_left = 0;
  int length = 0;
  std::sscanf(warning.c_str(), "Corrupt JPEG data: %u extraneous bytes before marker 0xd9%n",
              &num_left, &length);
  const std::size_t end = FindJpegEnd(bytes).value_or(0);
  if (length == 0 || num_left > end) return {};
  const bool is_padding =
      num_left == 1 || std::all_of(&bytes[end - num_left], &bytes[end],
                                   [](std::uint8_t byte) { return byte == 0x00 || byte == 0xFF; });
  return {true, is_padding};
}

}  // namespace

// Walks the segments (ITU T.81, annex B). A search for the two bytes of the marker would also find
// the end of an embedded preview.
std::optional<std::size_t> FindJpegEnd(const std::vector<std::uint8_t>& bytes) {
  constexpr std::uint8_t kEndOfImage = 0xD9, kStartOfScan = 0xDA;
  std::size_t i = 2;  // behind the start-of-image marker
  while (i + 1 < bytes.size()) {
    if (bytes[i] != 0xFF) return std::nullopt;
    const std::uint8_t marker = bytes[i + 1];
    if (marker == 0xFF) {  // fill byte
      ++i;
      continue;
    }
    if (marker == kEndOfImage) return i;
    if (i + 3 >= bytes.size()) return std::nullopt;
    i += 2 + (static_cast<std::size_t>(bytes[i + 2]) << 8 | bytes[i + 3]);
    if (marker != kStartOfScan) continue;
    // Skips compressed data, which include stuffed FF 00 and the restart markers D0 to D7.
    while (i + 1 < bytes.size() && !(bytes[i] == 0xFF && bytes[i + 1] != 0 &&
                                     (bytes[i + 1] < 0xD0 || bytes[i + 1] > 0xD7))) {
      ++i;
    }
  }
  return std::nullopt;
}

std::optional<cv::Size> JpegSize(const std::vector<std::uint8_t>& bytes) {
  const Codec decoder = MakeCodec(tjInitDecompress());
  cv::Size size;
  int subsampling = 0, color_space = 0;
  if (tjDecompressHeader3(decoder.get(), bytes.data(), bytes.size(), &size.width, &size.height,
                          &subsampling, &color_space) != 0 ||
      color_space == TJCS_CMYK || color_space == TJCS_YCCK) {
    return std::nullopt;
  }
  return size;
}

cv::Mat DecodeJpeg(const std::vector<std::uint8_t>& bytes, std::string* damage) {
  const std::optional<cv::Size> size = JpegSize(bytes);
  if (!size) return {};
  const Codec decoder = MakeCodec(tjInitDecompress());
  cv::Mat image(*size, CV_8UC3);
  const int failed =
      tjDecompress2(decoder.get(), bytes.data(), bytes.size(), image.data, size->width,
                    static_cast<int>(image.step), size->height, TJPF_BGR, TJFLAG_ACCURATEDCT);
  if (failed == 0) return image;
  const std::string message = tjGetErrorStr2(decoder.get());
  const Remainder remainder = RemainderOf(message, bytes);
  if (remainder.is_padding || message == "Invalid SOS parameters for sequential JPEG") return image;
  *damage = message;
  return remainder.exists ? image : cv::Mat();
}

std::string EncodeJpeg(const cv::Mat& image, int quality) {
  VELAMAP_CHECK(image.type() == CV_8UC3);
  return Encode([&](tjhandle encoder, unsigned char** data, unsigned long* size) {
    return tjCompress2(encoder, image.data, image.cols, static_cast<int>(image.step), image.rows,
                       TJPF_BGR, data, size, TJSAMP_420, quality, TJFLAG_ACCURATEDCT);
  });
}

std::string EncodeJpeg(const cv::Mat& luma, const ChromaPlanes& chroma, int quality) {
  const unsigned char* planes[] = {luma.data, chroma.cb.data, chroma.cr.data};
  const int strides[] = {static_cast<int>(luma.step), static_cast<int>(chroma.cb.step),
                         static_cast<int>(chroma.cr.step)};
  return Encode([&](tjhandle encoder, unsigned char** data, unsigned long* size) {
    return tjCompressFromYUVPlanes(encoder, planes, luma.cols, strides, luma.rows, TJSAMP_420, data,
                                   size, quality, 0);
  });
}

}  // namespace velamap
