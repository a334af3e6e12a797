// The mark of the JPEG files that velamap writes: a comment that holds the hash of the rest, which
// tells them from pictures of the user, and from frames that the user has changed.

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace velamap {

std::string WithFrameMark(std::string_view jpeg);

// Whether the file is as WithFrameMark() made it.
bool IsWrittenFrame(const std::filesystem::path& path);

}  // namespace velamap
