#include "importer/video/image_file.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

namespace velamap {
namespace {

using Bytes = std::vector<std::uint8_t>;

bool StartsWith(const Bytes& bytes, const std::vector<std::uint8_t>& signature) {
  return bytes.size() >= signature.size() &&
         std::equal(signature.begin(), signature.end(), bytes.begin());
}

// Walks the segments of a JPEG to its end-of-image marker (ITU T.81, annex B). A search for the two
// bytes of the marker would also find the end of an embedded preview.
bool JpegHasEnd(const Bytes& bytes) {
  constexpr std::uint8_t kEndOfImage = 0xD9, kStartOfScan = 0xDA;
  std::size_t i = 2;  // behind the start-of-image marker
  while (i + 1 < bytes.size()) {
    if (bytes[i] != 0xFF) return false;
    const std::uint8_t marker = bytes[i + 1];
    if (marker == 0xFF) {  // fill byte
      ++i;
      continue;
    }
    if (marker == kEndOfImage) return true;
    if (i + 3 >= bytes.size()) return false;
    i += 2 + (static_cast<std::size_t>(bytes[i + 2]) << 8 | bytes[i + 3]);
    if (marker != kStartOfScan) continue;
    // Skips compressed data, which include stuffed FF 00 and the restart markers D0 to D7.
    while (i + 1 < bytes.size() && !(bytes[i] == 0xFF && bytes[i + 1] != 0 &&
                                     (bytes[i + 1] < 0xD0 || bytes[i + 1] > 0xD7))) {
      ++i;
    }
  }
  return false;
}

// Walks the chunks of a PNG to IEND. A chunk is 4 bytes length, 4 bytes type, data, 4 bytes
// checksum.
bool PngHasEnd(const Bytes& bytes) {
  std::size_t i = 8;
  while (i + 12 <= bytes.size()) {
    std::size_t length = 0;
    for (std::size_t k = 0; k < 4; ++k) length = length << 8 | bytes[i + k];
    if (std::memcmp(&bytes[i + 4], "IEND", 4) == 0) return true;
    i += 12 + length;
  }
  return false;
}

}  // namespace

cv::Mat DecodeImageFile(const std::string& path, std::string* reason, std::size_t max_pixels) {
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  const std::int64_t size = stream.tellg();
  if (size > kMaxImageFileSize) {
    *reason = fmt::format("has {} bytes; pictures of at most {} are read", size, kMaxImageFileSize);
    return {};
  }
  stream.seekg(0);
  const Bytes bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (!stream.is_open() || stream.bad()) {
    *reason = "cannot be read";
  } else if (bytes.empty()) {
    *reason = "the file is empty";
  } else if ((StartsWith(bytes, {0xFF, 0xD8}) && !JpegHasEnd(bytes)) ||
             (StartsWith(bytes, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'}) &&
              !PngHasEnd(bytes))) {
    *reason = "the file is cut off";
  } else {
    try {
      const cv::Mat color = cv::imdecode(bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
      if (color.total() > max_pixels) {
        *reason = fmt::format("has {} x {} pixels; pictures of at most {} are read", color.cols,
                              color.rows, max_pixels);
        return {};
      }
      if (!color.empty()) return color;
    } catch (const cv::Exception&) {
      // Falls through: OpenCV throws for some damaged files and returns nothing for others.
    }
    *reason = "not an image that can be decoded";
  }
  return {};
}

}  // namespace velamap
