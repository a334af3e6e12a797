// Whole text files as strings.

#pragma once

#include <string>

namespace velamap {

// Throws InputError, naming `what` and the path, if the file is missing, a folder, unreadable or
// empty.
std::string ReadTextFile(const std::string& path, const std::string& what);

}  // namespace velamap
