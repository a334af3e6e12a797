#include "importer/video/jpeg_codec.h"

#include <memory>

#include <turbojpeg.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

using Codec = std::unique_ptr<void, int (*)(tjhandle)>;

struct EncodedBytes {
  std::unique_ptr<unsigned char, void (*)(unsigned char*)> data{nullptr, tjFree};
  unsigned long size = 0;

  std::string Text() const { return {reinterpret_cast<const char*>(data.get()), size}; }
};

Codec MakeCodec(tjhandle handle) {
  VELAMAP_CHECK(handle != nullptr);
  return {handle, tjDestroy};
}

// `compress` is given the addresses of a buffer, which it allocates, and of its size.
template <typename Compress>
std::string Encode(const Compress& compress) {
  const Codec encoder = MakeCodec(tjInitCompress());
  unsigned char* data = nullptr;
  EncodedBytes bytes;
  const int failed = compress(encoder.get(), &data, &bytes.size);
  bytes.data.reset(data);
  VELAMAP_CHECK(failed == 0);
  return bytes.Text();
}

}  // namespace

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

cv::Mat DecodeJpeg(const std::vector<std::uint8_t>& bytes) {
  const std::optional<cv::Size> size = JpegSize(bytes);
  if (!size) return {};
  const Codec decoder = MakeCodec(tjInitDecompress());
  cv::Mat image(*size, CV_8UC3);
  const int failed =
      tjDecompress2(decoder.get(), bytes.data(), bytes.size(), image.data, size->width,
                    static_cast<int>(image.step), size->height, TJPF_BGR, TJFLAG_ACCURATEDCT);
  if (failed != 0 && tjGetErrorCode(decoder.get()) != TJERR_WARNING) return {};
  return image;
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
