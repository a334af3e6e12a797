// Whole text files as strings.

#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace velamap {

// Calibrations, layouts, dictionaries and project files are far smaller.
inline constexpr std::uintmax_t kMaxTextFileSize = 16 << 20;

// Some programs write it at the beginning of a file in UTF-8.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// Throws InputError, naming `what` and the path, if the file is a folder, a pipe or the like, or
// larger than `max_size` bytes. Nothing happens if it is missing.
void CheckInputFile(const std::string& path, const std::string& what, std::uintmax_t max_size);

// The text without a byte order mark. Throws InputError, naming `what` and the path, if the file is
// missing, a folder, unreadable, empty, larger than kMaxTextFileSize, or has two such marks.
std::string ReadTextFile(const std::string& path, const std::string& what);

// Throws InputError that names the first line of the text that is not UTF-8. For files whose names
// go into pages, tables and CAD files, which are UTF-8.
void CheckUtf8(const std::string& text, const std::string& path);

}  // namespace velamap
