// Whole text files as strings.

#pragma once

#include <cstdint>
#include <string>

namespace velamap {

// Calibrations, layouts and dictionaries are far smaller.
inline constexpr std::uintmax_t kMaxTextFileSize = 64 << 20;

// The text without a byte order mark. Throws InputError, naming `what` and the path, if the file is
// missing, a folder, unreadable, empty, or larger than kMaxTextFileSize.
std::string ReadTextFile(const std::string& path, const std::string& what);

}  // namespace velamap
