// HEIF files (HEIC of phones, AVIF) through libheif.

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace velamap {

// Whether the file begins as HEIF does and libheif knows its codec.
bool IsHeif(const std::vector<std::uint8_t>& bytes);

// The size in the header, as viewers show the picture; nothing if the file is cut off or its
// structure is damaged. `bytes` begin as HEIF.
std::optional<cv::Size> HeifSize(const std::vector<std::uint8_t>& bytes);

// The primary picture, BGR, 8 bit, as stored: rotation, mirroring and cropping of the metadata are
// left out, as in other photographs. Empty if HeifSize() gives nothing, or if the data
// cannot be decoded; `*damage` then says why. Wrong bits in the data mostly decode to some picture.
cv::Mat DecodeHeif(const std::vector<std::uint8_t>& bytes, std::string* damage);

// The EXIF data of the primary picture, from "Exif\0\0" on; empty if it has none or the file cannot
// be read.
std::vector<std::uint8_t> ReadHeifExif(const std::string& path);

}  // namespace velamap
