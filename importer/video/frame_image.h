// Frames of a video as image files.

#pragma once

#include <filesystem>

#include "importer/video/frame_source.h"

namespace velamap {

// Writes a loaded frame as JPEG, atomically. Planes of a video that JPEG can take go into it as
// they are, with the frame's grey image as luma: twice as fast as through BGR, and what reads the
// file as grey sees what the detector saw. Throws InputError if the file cannot be written.
void WriteFrameImage(const Frame& frame, const std::filesystem::path& path);

}  // namespace velamap
