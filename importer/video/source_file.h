// Which file a picture or a video was read from, and what was in it then.

#pragma once

#include <cstdint>
#include <string>

namespace velamap {

struct SourceFile {
  std::string path;  // absolute
  std::uint64_t size = 0;
  std::int64_t modified_s = 0;  // since 1970, UTC
  std::uint64_t parts_hash =
      0;  // of 16 parts that are spread over the file, or the whole of a small one
};

// Whether the name has an extension of an image that OpenCV reads (.jpg, .png, .tif ...).
bool HasImageExtension(const std::string& path);

// Throws InputError if the file cannot be read.
SourceFile IdentifySource(const std::string& path);

// Whether both have the same content, whatever their names and times.
bool HaveSameContent(const SourceFile& one, const SourceFile& other);

// "path, 1234 bytes of 2024-05-01 14:02 UTC".
std::string SourceText(const SourceFile& source);

}  // namespace velamap
