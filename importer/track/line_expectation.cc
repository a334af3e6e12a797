#include "importer/track/line_expectation.h"

#include <cstddef>
#include <optional>
#include <set>

namespace velamap {
namespace {

// Two markers have the same orientation when their first sides differ by less than 30 degrees.
constexpr double kMinCosine = 0.87;

// Smallest size relative to the neighbour; where perspective makes a marker smaller, its place
// beyond the end of a line cannot be predicted.
constexpr double kMinSize = 0.6;

// Allow for variations of spacing and perspective.
constexpr double kReachPerDistance = 0.12, kReachPerSide = 0.3;

bool HaveSameOrientation(const QuadCorners& a, const QuadCorners& b) {
  const Eigen::Vector2d side_a = a[1] - a[0], side_b = b[1] - b[0];
  return side_a.dot(side_b) > kMinCosine * side_a.norm() * side_b.norm();
}

// weight_a * a + (1 - weight_a) * b for each corner.
std::optional<ExpectedMarker> Expect(int marker_id, const QuadById& quads, int id_a, int id_b,
                                     double weight_a) {
  const auto a = quads.find(id_a), b = quads.find(id_b);
  if (a == quads.end() || b == quads.end() || !HaveSameOrientation(a->second, b->second)) {
    return std::nullopt;
  }
  ExpectedMarker expected;
  expected.quad.marker_id = marker_id;
  for (std::size_t c = 0; c < kNumCorners; ++c) {
    expected.quad.corners_px[c] = weight_a * a->second[c] + (1 - weight_a) * b->second[c];
  }
  const double size = QuadMeanSide(expected.quad.corners_px) / QuadMeanSide(a->second);
  if (size < kMinSize || size > 1 / kMinSize) return std::nullopt;
  const double distance_px = (QuadCenter(a->second) - QuadCenter(b->second)).norm();
  expected.reach_px =
      kReachPerDistance * distance_px + kReachPerSide * QuadMeanSide(expected.quad.corners_px);
  return expected;
}

std::optional<ExpectedMarker> ExpectAt(const std::vector<int>& line, std::size_t place,
                                       const QuadById& quads) {
  const int id = line[place];
  const bool has_two_before = place >= 2, has_two_after = place + 2 < line.size();
  if (place >= 1 && place + 1 < line.size()) {
    const auto between = Expect(id, quads, line[place - 1], line[place + 1], 0.5);
    if (between) return between;
  }
  if (has_two_before) {
    const auto beyond = Expect(id, quads, line[place - 1], line[place - 2], 2.0);
    if (beyond) return beyond;
  }
  if (has_two_after) return Expect(id, quads, line[place + 1], line[place + 2], 2.0);
  return std::nullopt;
}

}  // namespace

std::vector<std::vector<int>> LinesOfLayout(const Layout& layout) {
  std::vector<std::vector<int>> lines;
  for (const LayoutPart& part : layout.parts) {
    for (const MarkerLine& line : part.horizontal) lines.push_back(line.marker_ids);
    for (const MarkerLine& line : part.vertical) lines.push_back(line.marker_ids);
    if (!part.marker_ids.empty()) lines.push_back(part.marker_ids);
  }
  return lines;
}

std::vector<ExpectedMarker> ExpectOnLines(const std::vector<std::vector<int>>& lines,
                                          const std::vector<MarkerQuad>& found) {
  const QuadById quads = SingleMarkers(found);
  std::set<int> done;
  for (const MarkerQuad& quad : found) done.insert(quad.marker_id);
  std::vector<ExpectedMarker> all;
  for (const std::vector<int>& line : lines) {
    for (std::size_t place = 0; place < line.size(); ++place) {
      if (done.count(line[place]) > 0) continue;
      const auto expected = ExpectAt(line, place, quads);
      if (!expected) continue;
      done.insert(line[place]);
      all.push_back(*expected);
    }
  }
  return all;
}

}  // namespace velamap
