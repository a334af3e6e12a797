#include "importer/layout/frame_choice.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/ids.h"
#include "importer/base/numbers.h"

namespace velamap {
namespace {

constexpr std::array<std::pair<const char*, FrameKind>, 4> kKeywords = {
    {{"known_points", FrameKind::kKnownPoints},
     {"reference_part", FrameKind::kReferencePart},
     {"lines", FrameKind::kLines},
     {"camera", FrameKind::kCamera}}};

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
  const auto ids = ParseNumberList<int>(text).value_or(std::vector<int>());
  const auto is_marker_id = [](int id) { return id >= 0 && id <= kMaxMarkerId; };
  if (ids.size() != kNumIds || std::set<int>(ids.begin(), ids.end()).size() != kNumIds ||
      !std::all_of(ids.begin(), ids.end(), is_marker_id)) {
    throw InputError(
        fmt::format("{}: '{}' is not a frame; expected known_points, reference_part, lines, "
                    "camera, or the ids of "
                    "three different markers (origin,axis,plane) such as 12,15,40",
                    what, text));
  }
  choice.kind = FrameKind::kMarkers;
  choice.origin_id = ids[0];
  choice.axis_id = ids[1];
  choice.plane_id = ids[2];
  return choice;
}

}  // namespace velamap
