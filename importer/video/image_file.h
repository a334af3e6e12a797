// Decodes image files and detects broken ones.

#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

namespace velamap {

// More than any camera has. A larger picture of a single colour takes little space on disk but
// minutes to search.
inline constexpr std::int64_t kMaxImageFileSize = std::int64_t{1} << 30;
inline constexpr std::size_t kMaxImagePixels = 250'000'000;

// Decodes the file to BGR, 8 bit, without the rotation of its metadata, which COLMAP also ignores.
// Returns an empty image and a reason if the file is missing, empty, cut off, too large or not an
// image, or is a JPEG in which libjpeg-turbo notices damage. JPEG and PNG files are checked for
// their end first, because decoders fill missing pixels with grey. A reason beside an image says
// what may be wrong with it.
cv::Mat DecodeImageFile(const std::string& path, std::string* reason,
                        std::size_t max_pixels = kMaxImagePixels);

}  // namespace velamap
