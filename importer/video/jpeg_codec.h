// JPEG files through libjpeg-turbo.

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/video/video_picture.h"

namespace velamap {

// Returns the size in the header; nothing if libjpeg-turbo cannot decode the file to BGR, such as a
// CMYK file.
std::optional<cv::Size> JpegSize(const std::vector<std::uint8_t>& bytes);

// The place of the end-of-image marker; nothing if the file is cut off before it.
std::optional<std::size_t> FindJpegEnd(const std::vector<std::uint8_t>& bytes);

// Decodes to BGR, 8 bit. Returns an empty picture where JpegSize() returns nothing, and for damaged
// data, because the pixels after the damage are wrong or displaced. `*damage` then says what
// libjpeg-turbo has noticed; if a picture is returned as well, damage is only a suspicion. Wrong
// bits that decode to a plausible picture remain unnoticed.
cv::Mat DecodeJpeg(const std::vector<std::uint8_t>& bytes, std::string* damage);

// The bytes of a file with chroma at half the width and height. `image` is BGR, 8 bit; `quality`
// runs from 1 to 100.
std::string EncodeJpeg(const cv::Mat& image, int quality);

// Encodes the planes without converting them; `luma` has full range.
std::string EncodeJpeg(const cv::Mat& luma, const ChromaPlanes& chroma, int quality);

}  // namespace velamap
