// Still pictures of formats other than JPEG, through FFmpeg.

#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace velamap {

// Decodes the bytes of a PNG, TIFF, BMP, WebP, JPEG 2000, PNM, Sun raster or OpenEXR file, or of a
// CMYK JPEG, to BGR, 8 bit. Drops transparency. Decodes the first picture of a file with several.
// Empty for anything else, for files in which FFmpeg notices damage, and beyond the 268 million
// pixels that it decodes. Thread-safe.
cv::Mat DecodeWithFfmpeg(const std::vector<std::uint8_t>& bytes);

}  // namespace velamap
