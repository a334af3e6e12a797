#include "importer/video/frame_image.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <string_view>
#include <vector>

#include <turbojpeg.h>
#include <opencv2/imgcodecs.hpp>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/video/written_frame.h"

namespace velamap {
namespace {

constexpr int kJpegQuality = 92;

struct JpegBytes {
  std::unique_ptr<unsigned char, void (*)(unsigned char*)> data{nullptr, tjFree};
  unsigned long size = 0;
};

JpegBytes EncodePlanes(const cv::Mat& luma, const ChromaPlanes& chroma) {
  const std::unique_ptr<void, int (*)(tjhandle)> encoder(tjInitCompress(), tjDestroy);
  VELAMAP_CHECK(encoder != nullptr);
  const unsigned char* planes[] = {luma.data, chroma.cb.data, chroma.cr.data};
  const int strides[] = {static_cast<int>(luma.step), static_cast<int>(chroma.cb.step),
                         static_cast<int>(chroma.cr.step)};
  unsigned char* data = nullptr;
  JpegBytes bytes;
  const int failed = tjCompressFromYUVPlanes(encoder.get(), planes, luma.cols, strides, luma.rows,
                                             TJSAMP_420, &data, &bytes.size, kJpegQuality, 0);
  bytes.data.reset(data);
  VELAMAP_CHECK(failed == 0);
  return bytes;
}

template <typename Byte>
void WriteBytes(const std::filesystem::path& path, const Byte* data, std::size_t size) {
  const std::string_view jpeg(reinterpret_cast<const char*>(data), size);
  WriteFileAtomicallyUnsynced(path, [&](std::ostream& out) { out << WithFrameMark(jpeg); });
}

}  // namespace

void WriteFrameImage(const Frame& frame, const std::filesystem::path& path) {
  const std::optional<ChromaPlanes> chroma =
      frame.picture ? frame.picture->HalfSizeChroma() : std::nullopt;
  if (chroma) {
    const JpegBytes bytes = EncodePlanes(frame.gray, *chroma);
    WriteBytes(path, bytes.data.get(), bytes.size);
  } else {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", ColorImage(frame), bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
    WriteBytes(path, bytes.data(), bytes.size());
  }
}

}  // namespace velamap
