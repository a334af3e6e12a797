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

// The size in the header; nothing if libjpeg-turbo cannot decode the file to BGR, such as one with
// four inks.
std::optional<cv::Size> JpegSize(const std::vector<std::uint8_t>& bytes);

// The place of the end-of-image marker; nothing if the file is cut off before it.
std::optional<std::size_t> FindJpegEnd(const std::vector<std::uint8_t>& bytes);

// BGR, 8 bit. Empty where JpegSize() gives nothing, and where the data are damaged: from the damage
// on, a decoder yields other pixels or the right ones in another place. `*damage` then says what
// libjpeg-turbo has noticed; with a picture it is only a suspicion. Some wrong bits decode to a
// plausible picture, and nobody notices them.
cv::Mat DecodeJpeg(const std::vector<std::uint8_t>& bytes, std::string* damage);

// The bytes of a file with chroma at half the width and height. `image` is BGR, 8 bit; `quality`
// runs from 1 to 100.
std::string EncodeJpeg(const cv::Mat& image, int quality);

// Takes the planes over as they are; `luma` has full range.
std::string EncodeJpeg(const cv::Mat& luma, const ChromaPlanes& chroma, int quality);

}  // namespace velamap
