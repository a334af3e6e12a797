// Ids of markers in a line of text.

#pragma once

#include <string>
#include <vector>

namespace velamap {

// `0-7 9 11`; at most ten numbers or ranges, then `...`. "none" for no ids.
std::string IdRanges(std::vector<int> ids);

}  // namespace velamap
