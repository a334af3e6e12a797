#include "importer/video/image_file.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "importer/photo/heif_picture.h"
#include "importer/video/ffmpeg_picture.h"
#include "importer/video/jpeg_codec.h"

namespace velamap {
namespace {

using Bytes = std::vector<std::uint8_t>;

bool StartsWith(const Bytes& bytes, const std::vector<std::uint8_t>& signature) {
  return bytes.size() >= signature.size() &&
         std::equal(signature.begin(), signature.end(), bytes.begin());
}

bool IsJpeg(const Bytes& bytes) { return StartsWith(bytes, {0xFF, 0xD8}); }

bool IsPng(const Bytes& bytes) {
  return StartsWith(bytes, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'});
}

std::uint32_t BigEndian32(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 |
         std::uint32_t{bytes[2]} << 8 | bytes[3];
}

// Walks the chunks of a PNG to IEND. A chunk is 4 bytes length, 4 bytes type, data, 4 bytes
// checksum.
bool PngHasEnd(const Bytes& bytes) {
  std::size_t i = 8;
  while (i + 12 <= bytes.size()) {
    if (std::memcmp(&bytes[i + 4], "IEND", 4) == 0) return true;
    i += std::size_t{12} + BigEndian32(&bytes[i]);
  }
  return false;
}

// The size in the header, so that no image that is too large is decoded; nothing for other formats.
std::optional<cv::Size2d> StoredSize(const Bytes& bytes) {
  constexpr std::size_t kPngSize = 16;  // behind signature, length and type of the first chunk
  if (IsPng(bytes) && bytes.size() >= kPngSize + 8) {
    return cv::Size2d(BigEndian32(&bytes[kPngSize]), BigEndian32(&bytes[kPngSize + 4]));
  }
  if (IsJpeg(bytes)) return JpegSize(bytes);
  if (IsHeif(bytes)) return HeifSize(bytes);
  return std::nullopt;
}

cv::Mat Decode(const Bytes& bytes, std::size_t max_pixels, std::string* reason) {
  const auto is_small = [&](const cv::Size2d& size) {
    if (size.area() <= static_cast<double>(max_pixels)) return true;
    *reason = fmt::format("has {} x {} pixels, more than the limit of {} pixels", size.width,
                          size.height, max_pixels);
    return false;
  };
  const std::optional<cv::Size2d> stored_size = StoredSize(bytes);
  if (stored_size && !is_small(*stored_size)) return {};
  cv::Mat color;
  std::string damage;
  if (IsJpeg(bytes)) color = DecodeJpeg(bytes, &damage);
  if (IsHeif(bytes)) color = DecodeHeif(bytes, &damage);
  if (!damage.empty() && color.empty()) {
    *reason = fmt::format("the file is damaged ({}); copy it from the camera again", damage);
    return {};
  }
  if (!damage.empty()) {
    *reason = fmt::format("may be damaged ({}); compare it with the file in the camera", damage);
  }
  if (color.empty()) color = DecodeWithFfmpeg(bytes);
  if (color.empty()) *reason = "not an image that can be decoded";
  return is_small(color.size()) ? color : cv::Mat();
}

}  // namespace

cv::Mat DecodeImageFile(const std::string& path, std::string* reason, std::size_t max_pixels) {
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  const std::int64_t size = stream.tellg();
  if (size > kMaxImageFileSize) {
    *reason = fmt::format("has {} bytes, more than the limit of {} bytes", size, kMaxImageFileSize);
    return {};
  }
  Bytes bytes(static_cast<std::size_t>(std::max(size, std::int64_t{0})));
  stream.seekg(0);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), size)) {
    *reason = "cannot be read";
  } else if (bytes.empty()) {
    *reason = "the file is empty";
  } else if ((IsJpeg(bytes) && !FindJpegEnd(bytes)) || (IsPng(bytes) && !PngHasEnd(bytes))) {
    *reason = "the file is cut off";
  } else {
    return Decode(bytes, max_pixels, reason);
  }
  return {};
}

}  // namespace velamap
