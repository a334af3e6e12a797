// The JPEG files into which frames of a video are written. Each carries a mark: a JPEG comment with
// the hash of the rest of the file. It tells these files from the user's own pictures and from
// frames that the user has changed.

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "importer/video/frame_source.h"

namespace velamap {

// Writes a loaded frame as a marked JPEG: the whole file or none, without waiting for the disk (see
// SyncFileSystem() of importer/base/atomic_output.h). Planes of a video that JPEG can hold are
// taken over, with the frame's grey image as luma. This is twice as fast as a conversion through
// BGR, and the file read as grey is the image that the detector saw. Throws InputError if the file
// cannot be written.
void WriteFrameImage(const Frame& frame, const std::filesystem::path& path);

std::string WithFrameMark(std::string_view jpeg);

// Whether the file is as WithFrameMark() made it.
bool IsWrittenFrame(const std::filesystem::path& path);

}  // namespace velamap
