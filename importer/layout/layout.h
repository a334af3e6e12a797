// The layout holds the prior knowledge of the markers: dictionary, sizes and places on the object.
//
// It gives the adjacency graph of thesis section 3.1: neighbours on a line are adjacent, and so are
// all markers of a rigid part.

#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "importer/base/ids.h"
#include "importer/layout/frame_choice.h"
#include "importer/layout/known_point.h"

namespace velamap {

// Markers on one line, from luff to leech (horizontal) or from foot to head (vertical).
struct MarkerLine {
  std::string name;
  std::vector<int> marker_ids;
};

// Where an edge of the cloth is; unknown if all members are empty.
struct ClothEdge {
  // Distances along the surface from the centres of the outer markers to the edge, m: one distance,
  // or for luff and leech also one for each horizontal line. Beyond a line or points: one at most.
  std::vector<double> offsets_m;
  // The line of markers that lies along the edge: a vertical one for luff and leech, the first or
  // the last horizontal one for foot and head.
  std::string line;
  // Two or more points of markers along the edge; corner 0 is the centre.
  std::vector<CornerId> points{};

  // For luff and leech, by horizontal line of the part.
  std::optional<double> OffsetOfLine(std::size_t line_idx) const {
    if (offsets_m.empty()) return std::nullopt;
    return offsets_m[offsets_m.size() == 1 ? 0 : line_idx];
  }
  bool IsKnown() const { return !offsets_m.empty() || !line.empty() || !points.empty(); }
  bool HasPlaces() const { return !line.empty() || !points.empty(); }
};

struct ClothEdges {
  ClothEdge luff, leech, foot, head;
};

struct LayoutPart {
  std::string name;
  bool rigid = false;
  std::vector<MarkerLine> horizontal;
  std::vector<MarkerLine> vertical;
  std::vector<int> marker_ids;  // on the part but on no line
  ClothEdges edges{};
};

// A straight distance measured by hand between two marker points. Corner 0 is the centre.
struct KnownDistance {
  int marker_id1 = 0, corner1 = 0;
  int marker_id2 = 0, corner2 = 0;
  double length_m = 0.0;
  double sigma_m = 0.0;       // of the measurement
  bool is_scale_bar = false;  // used in the adjustment; otherwise only compared with the result
};

struct Layout {
  // An OpenCV predefined name (DICT_4X4_50) or the path of a dictionary file.
  std::string dictionary;
  double marker_length_m = 0.0;               // outer edge of the black square
  std::map<int, double> marker_lengths_m;     // exceptions, by marker id
  int border_bits = 1;                        // width of the black border, cells
  std::vector<LayoutPart> parts;              // empty: all ids belong to one part
  std::optional<std::string> reference_part;  // motion is measured relative to it
  std::vector<KnownDistance> distances;
  std::vector<KnownPoint> known_points;
  std::optional<FrameChoice> frame;  // of the result; if not set, the best available
  // What marker_length_m was on the sheets before a printer changed it. Only prints use it.
  std::optional<double> drawn_length_m{};

  // Whether the layout lists its markers. If not, every id is accepted.
  bool HasMarkers() const { return !parts.empty(); }
};

// Reads a layout file (YAML; the README.md of this folder lists the keys). The path of a dictionary
// file is relative to the layout file. Throws InputError that names file, line and key for unknown
// keys and invalid values: for example a marker that is twice on a line, on two horizontal lines,
// in two parts or has two lengths; a marker length outside of 0.1 mm to 10 m; an edge that does not
// fit the lines; a distance or known point that is incomplete or of a marker that no part names; a
// known point that is given twice; and a frame for which the layout lacks the markers, part, lines
// or points. Warns of marker lengths that are not used because no part names the marker.
Layout ReadLayout(const std::string& path);

// The layout for --dictionary and --marker_length, which has no parts and accepts every id. Throws
// InputError for a length out of range.
Layout MakeLayout(const std::string& dictionary, double marker_length_m);

// The allowed range of the outer edge of the black square.
constexpr double kMinMarkerLength_m = 1e-4, kMaxMarkerLength_m = 10.0;

// Throws InputError for a length out of this range. `what` is the name of the key or option.
void CheckMarkerLength(double length_m, const std::string& what);

// The length of the marker's side, m.
double MarkerLength(const Layout& layout, int marker_id);

// The ids that the layout or the part names, ascending, each once.
std::vector<int> MarkerIds(const Layout& layout);
std::set<int> MarkerIds(const LayoutPart& part);

// The name of the part that holds the marker, or "" if none does.
std::string PartOfMarker(const Layout& layout, int marker_id);

// The first part with horizontal lines; null without any.
const LayoutPart* FirstPartWithLines(const Layout& layout);

using AdjacencyGraph = std::map<int, std::vector<int>>;
AdjacencyGraph BuildAdjacencyGraph(const Layout& layout);

// The smallest number of edges from `marker_id` to each marker that can be reached from it. Empty
// if `marker_id` is not in the graph.
std::map<int, int> TopologicalDistances(const AdjacencyGraph& graph, int marker_id);

}  // namespace velamap
