// What a photograph's EXIF says about its camera.

#pragma once

#include <optional>
#include <string>

namespace velamap {

struct PictureMetadata {
  // Clockwise quarter turns that put the stored pixels upright, 0 to 3. 0 without the tag, and for
  // mirrored pictures, which no camera writes.
  int quarter_turns = 0;
  // Focal length as a multiple of the picture's diagonal, from the 35 mm equivalent (43.27 mm of
  // diagonal), else from focal length and resolution of the focal plane. A claim, not a fact:
  // cropped and scaled pictures keep the tag.
  std::optional<double> focal_in_diagonals;
};

// Defaults for a file without EXIF or with damaged EXIF. Reads JPEG and HEIF files. Thread-safe.
PictureMetadata ReadPictureMetadata(const std::string& path);

}  // namespace velamap
