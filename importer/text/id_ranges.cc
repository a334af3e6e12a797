#include "importer/text/id_ranges.h"

#include <algorithm>

#include <fmt/format.h>

#include "importer/base/ids.h"
#include "importer/base/numbers.h"

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

bool ParseMarkerId(std::string_view text, int* id) {
  int number = -1;
  if (!ParseNumber(text, &number) || number < 0 || number > kMaxMarkerId) return false;
  *id = number;
  return true;
}

std::optional<std::vector<int>> ParseIdRange(std::string_view text) {
  const std::size_t dash = text.find('-');
  int first = 0;
  if (!ParseMarkerId(text.substr(0, dash), &first)) return std::nullopt;
  int last = first;
  if (dash != std::string_view::npos && !ParseMarkerId(text.substr(dash + 1), &last)) {
    return std::nullopt;
  }
  std::vector<int> ids = {first};
  while (ids.back() != last) ids.push_back(ids.back() + (first < last ? 1 : -1));
  return ids;
}

std::optional<std::vector<int>> ParseIdList(std::string_view text) {
  std::vector<int> ids;
  while (true) {
    const std::size_t comma = text.find(',');
    const auto range = ParseIdRange(text.substr(0, comma));
    if (!range) return std::nullopt;
    ids.insert(ids.end(), range->begin(), range->end());
    if (comma == std::string_view::npos) return ids;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace velamap
