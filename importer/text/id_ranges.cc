#include "importer/text/id_ranges.h"

#include <algorithm>

#include <fmt/format.h>

namespace velamap {

std::string IdRanges(std::vector<int> ids) {
  std::sort(ids.begin(), ids.end());
  constexpr int kMaxNumRanges = 10;
  std::string text;
  int num_ranges = 0;
  for (std::size_t begin = 0, end = 0; begin < ids.size(); begin = end) {
    if (++num_ranges > kMaxNumRanges) return text + " ...";
    for (end = begin + 1; end < ids.size() && ids[end] == ids[end - 1] + 1; ++end) {
    }
    if (begin > 0) text += " ";
    text += std::to_string(ids[begin]);
    if (end > begin + 1) text += fmt::format("-{}", ids[end - 1]);
  }
  return ids.empty() ? "none" : text;
}

}  // namespace velamap
