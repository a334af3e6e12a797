// Ids of markers in text.

#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace velamap {

// `0-7 9 11`; at most ten numbers or ranges, then `...`. "none" for no ids.
std::string IdRanges(std::vector<int> ids);

// Returns whether the text is a marker id, 0 to kMaxMarkerId; `id` is left alone otherwise.
bool ParseMarkerId(std::string_view text, int* id);

// The ids of a text such as `7`, `0-16` or, in descending order, `16-0`. Returns nothing for other
// text.
std::optional<std::vector<int>> ParseIdRange(std::string_view text);

// The same for several ids and ranges separated by commas, such as `3,17,20-25`.
std::optional<std::vector<int>> ParseIdList(std::string_view text);

}  // namespace velamap
