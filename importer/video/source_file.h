// Which file a picture or a video was read from, and its content at that time.

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace velamap {

struct SourceFile {
  std::string name;             // without folders, because people share databases
  std::uint64_t path_hash = 0;  // of the absolute path without links
  std::uint64_t size = 0;
  std::int64_t modified_s = 0;  // since 1970, UTC
  // When content, name or permissions were last changed (ctime, which programs cannot set), since
  // 1970.
  std::int64_t changed_ns = 0;
  // Taken from the whole picture, or from 16 parts that are spread over a video, because an encoded
  // video that is changed somewhere is changed in many places.
  std::uint64_t content_hash = 0;
};

// Whether the name has an extension of an image that velamap reads (.jpg, .png, .tif ...).
bool HasImageExtension(const std::string& path);

// Returns the end of the error message for a folder without pictures that velamap reads: the
// remedies that the names of its files suggest, each after a semicolon.
std::string RemedyForNoImages(const std::filesystem::path& folder,
                              const std::vector<std::string>& names);

// Throws InputError if the file cannot be read.
SourceFile IdentifySource(const std::string& path);

// Whether the file at `path` has the content that was read from `known`; its name and times may
// differ. It is not read if nothing has touched it since. Throws InputError if it cannot be read.
bool HasSameContent(const SourceFile& known, const std::string& path);

// Whether `known` was read from `path`, even if the file has changed since.
bool IsSamePlace(const SourceFile& known, const std::filesystem::path& path);

// "clip.mp4, 1234 bytes of 2024-05-01 14:02 UTC".
std::string SourceText(const SourceFile& source);

}  // namespace velamap
