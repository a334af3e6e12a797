// Decodes image files and tells whole ones from broken ones.

#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace velamap {

// Decodes the file to BGR, 8 bit, without the rotation of its metadata, which COLMAP ignores too.
// Returns an empty image and a reason if the file is missing, empty, cut off or not an image. JPEG
// and PNG files are checked for their end first, because decoders fill missing pixels with grey.
cv::Mat DecodeImageFile(const std::string& path, std::string* reason);

}  // namespace velamap
