#include "importer/layout/frame_choice.h"

#include <array>
#include <charconv>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/ids.h"

namespace velamap {
namespace {

constexpr std::array<std::pair<const char*, FrameKind>, 3> kKeywords = {
    {{"reference_part", FrameKind::kReferencePart},
     {"lines", FrameKind::kLines},
     {"camera", FrameKind::kCamera}}};

// Whole numbers that commas separate; empty when any is no marker id.
std::vector<int> ParseIds(const std::string& text) {
  std::vector<int> ids;
  const char* begin = text.data();
  const char* const text_end = begin + text.size();
  while (true) {
    int id = -1;
    const auto [end, error] = std::from_chars(begin, text_end, id);
    if (error != std::errc() || id < 0 || id > kMaxMarkerId) return {};
    ids.push_back(id);
    if (end == text_end) return ids;
    if (*end != ',') return {};
    begin = end + 1;
  }
}

}  // namespace

std::string FrameKeyword(FrameKind kind) {
  for (const auto& [keyword, keyword_kind] : kKeywords) {
    if (keyword_kind == kind) return keyword;
  }
  VELAMAP_CHECK(false && "a frame by markers has no keyword");
  return "";
}

bool ParseFrameKeyword(const std::string& text, FrameKind* kind) {
  for (const auto& [keyword, keyword_kind] : kKeywords) {
    if (text != keyword) continue;
    *kind = keyword_kind;
    return true;
  }
  return false;
}

FrameChoice ParseFrameChoice(const std::string& text, const std::string& what) {
  constexpr std::size_t kNumIds = 3;
  FrameChoice choice;
  if (ParseFrameKeyword(text, &choice.kind)) return choice;
  const std::vector<int> ids = ParseIds(text);
  if (ids.size() != kNumIds || std::set<int>(ids.begin(), ids.end()).size() != kNumIds) {
    throw InputError(
        fmt::format("{}: '{}' is no frame; reference_part, lines, camera, or the ids of three "
                    "different markers (origin,axis,plane) such as 12,15,40 are expected",
                    what, text));
  }
  choice.kind = FrameKind::kMarkers;
  choice.origin_id = ids[0];
  choice.axis_id = ids[1];
  choice.plane_id = ids[2];
  return choice;
}

}  // namespace velamap
