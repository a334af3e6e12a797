// Writes frames of a video as image files.

#pragma once

#include <filesystem>

#include "importer/video/frame_source.h"

namespace velamap {

// Writes a loaded frame as JPEG: the whole file or none, without waiting for the disk (see
// SyncFileSystem() of importer/base/atomic_output.h). Planes of a video that JPEG can hold are
// taken over, with the frame's grey image as luma. This is twice as fast as a conversion through
// BGR, and the file read as grey is the image that the detector saw. Throws InputError if the file
// cannot be written.
// The file is marked (written_frame.h).
void WriteFrameImage(const Frame& frame, const std::filesystem::path& path);

}  // namespace velamap
