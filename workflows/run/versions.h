// What velamap works with, for `velamap version` and the report.

#pragma once

#include <string>
#include <utility>
#include <vector>

namespace velamap {

// Pairs of name and version: the libraries that it was built with, then COLMAP as it is found now.
// Not having COLMAP is an answer here, not a failure.
std::vector<std::pair<std::string, std::string>> LibraryVersions(const std::string& colmap_path);

}  // namespace velamap
