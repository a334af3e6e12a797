// Versions of the libraries and of COLMAP, for `velamap version` and the report.

#pragma once

#include <string>
#include <utility>
#include <vector>

namespace velamap {

// Pairs of name and version: the libraries that velamap was built with, then COLMAP as it is found
// when this is called. A missing COLMAP is not an error here.
std::vector<std::pair<std::string, std::string>> LibraryVersions(const std::string& colmap_path);

}  // namespace velamap
