#include "importer/layout/layout.h"

#include <algorithm>
#include <deque>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

void Connect(int a, int b, AdjacencyGraph* graph) {
  if (a == b) return;
  (*graph)[a].push_back(b);
  (*graph)[b].push_back(a);
}

void ConnectLines(const std::vector<MarkerLine>& lines, AdjacencyGraph* graph) {
  for (const MarkerLine& line : lines) {
    for (std::size_t i = 1; i < line.marker_ids.size(); ++i) {
      Connect(line.marker_ids[i - 1], line.marker_ids[i], graph);
    }
  }
}

}  // namespace

Layout MakeLayout(const std::string& dictionary, double marker_length_m) {
  CheckMarkerLength(marker_length_m, "--marker_length");
  Layout layout;
  layout.dictionary = dictionary;
  layout.marker_length_m = marker_length_m;
  return layout;
}

void CheckMarkerLength(double length_m, const std::string& what) {
  if (!(length_m >= kMinMarkerLength_m && length_m <= kMaxMarkerLength_m)) {
    const bool may_be_mm = length_m > kMaxMarkerLength_m && length_m < 1000 * kMaxMarkerLength_m;
    throw InputError(
        fmt::format("{}: {} m is not a marker side; give the outer edge of the black square in "
                    "metres, {} to {}{}",
                    what, length_m, kMinMarkerLength_m, kMaxMarkerLength_m,
                    may_be_mm ? fmt::format(" ({} for {} mm)", length_m / 1000, length_m) : ""));
  }
}

double MarkerLength(const Layout& layout, int marker_id) {
  const auto exception = layout.marker_lengths_m.find(marker_id);
  return exception != layout.marker_lengths_m.end() ? exception->second : layout.marker_length_m;
}

std::set<int> MarkerIds(const LayoutPart& part) {
  std::set<int> ids(part.marker_ids.begin(), part.marker_ids.end());
  for (const std::vector<MarkerLine>* lines : {&part.horizontal, &part.vertical}) {
    for (const MarkerLine& line : *lines)
      ids.insert(line.marker_ids.begin(), line.marker_ids.end());
  }
  return ids;
}

std::vector<int> MarkerIds(const Layout& layout) {
  std::set<int> ids;
  for (const LayoutPart& part : layout.parts) ids.merge(MarkerIds(part));
  return {ids.begin(), ids.end()};
}

std::string PartOfMarker(const Layout& layout, int marker_id) {
  for (const LayoutPart& part : layout.parts) {
    if (MarkerIds(part).count(marker_id) > 0) return part.name;
  }
  return "";
}

const LayoutPart* FirstPartWithLines(const Layout& layout) {
  for (const LayoutPart& part : layout.parts) {
    if (!part.horizontal.empty()) return &part;
  }
  return nullptr;
}

AdjacencyGraph BuildAdjacencyGraph(const Layout& layout) {
  AdjacencyGraph graph;
  for (const LayoutPart& part : layout.parts) {
    const std::set<int> ids = MarkerIds(part);
    for (const int id : ids) graph[id];
    ConnectLines(part.horizontal, &graph);
    ConnectLines(part.vertical, &graph);
    if (!part.rigid) continue;
    for (const int a : ids) {
      for (const int b : ids) {
        if (a < b) Connect(a, b, &graph);
      }
    }
  }
  for (auto& [id, neighbors] : graph) {
    std::sort(neighbors.begin(), neighbors.end());
    neighbors.erase(std::unique(neighbors.begin(), neighbors.end()), neighbors.end());
  }
  return graph;
}

std::map<int, int> TopologicalDistances(const AdjacencyGraph& graph, int marker_id) {
  std::map<int, int> distances;
  if (graph.count(marker_id) == 0) return distances;
  distances[marker_id] = 0;
  std::deque<int> queue = {marker_id};
  while (!queue.empty()) {
    const int id = queue.front();
    queue.pop_front();
    for (const int neighbor : graph.at(id)) {
      if (distances.emplace(neighbor, distances.at(id) + 1).second) queue.push_back(neighbor);
    }
  }
  return distances;
}

}  // namespace velamap
