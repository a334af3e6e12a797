// Decodes image files and tells whole ones from broken ones.

#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace velamap {

// Whether the name ends like a picture that OpenCV reads (.jpg, .png, .tif ...).
bool HasImageExtension(const std::string& path);

// Decodes the file to BGR, 8 bit, not rotated by its metadata (COLMAP ignores it too). Decoders
// fill what is missing of a broken file with grey, so JPEG and PNG are checked for their end first.
// Returns an empty image and a reason if the file is missing, empty, cut off or no image.
cv::Mat DecodeImageFile(const std::string& path, std::string* reason);

}  // namespace velamap
