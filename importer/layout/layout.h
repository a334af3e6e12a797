// The prior knowledge of the markers: dictionary, sizes, and their places on the object.
//
// The adjacency graph of thesis section 3.1 follows from the lines: neighbours on a line are
// adjacent, and so are all markers of a rigid part.

#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "importer/layout/frame_choice.h"
#include "importer/layout/known_point.h"

namespace velamap {

// Markers on one line, from luff to leech (horizontal) or from foot to head (vertical).
struct MarkerLine {
  std::string name;
  std::vector<int> marker_ids;
};

// Where an edge of the cloth is; unknown if both are empty.
struct ClothEdge {
  // Distances along the surface from the centres of the outer markers to the edge, m: one for all
  // horizontal lines, or for luff and leech one for each line.
  std::vector<double> offsets_m;
  std::string line;  // of luff or leech: the vertical line of markers on the edge

  bool IsKnown() const { return !offsets_m.empty() || !line.empty(); }
};

struct ClothEdges {
  ClothEdge luff, leech, foot, head;
};

struct LayoutPart {
  std::string name;
  bool rigid = false;
  std::vector<MarkerLine> horizontal;
  std::vector<MarkerLine> vertical;
  std::vector<int> marker_ids;  // on the part, on no line
  ClothEdges edges{};
};

// A length measured by hand between two marker points (corner 0: the centre).
struct KnownDistance {
  int marker_id1 = 0, corner1 = 0;
  int marker_id2 = 0, corner2 = 0;
  double length_m = 0.0;
  double sigma_m = 0.0;       // of the measurement
  bool is_scale_bar = false;  // takes part in the adjustment; otherwise it is a check of the result
};

struct Layout {
  // An OpenCV predefined name (DICT_4X4_50) or the path of a dictionary file.
  std::string dictionary;
  double marker_length_m = 0.0;               // outer edge of the black square
  std::map<int, double> marker_lengths_m;     // exceptions
  int border_bits = 1;                        // width of the black border, cells
  std::vector<LayoutPart> parts;              // empty: all ids belong to one part
  std::optional<std::string> reference_part;  // motion is measured relative to it
  std::vector<KnownDistance> distances;
  std::vector<KnownPoint> known_points;
  std::optional<FrameChoice> frame;  // of the result; nothing: the best available

  // Whether the layout lists its markers; without a list every id is accepted.
  bool HasMarkers() const { return !parts.empty(); }
};

// Reads a layout file (YAML; README.md of this folder lists the keys). The path of a dictionary
// file is relative to the layout file. Throws InputError that names file, line and key for unknown
// keys, a marker twice on one line or in two parts or with two lengths, a length that is not
// between 0.1 mm and 10 m, a negative id, an edge that its lines do not allow, a distance of a
// marker that no part names, of a point from itself, or without a sigma, and a known point that is
// given twice, of a marker that no part names, or without a coordinate or a sigma. Warns of a
// length of a marker that no part names.
Layout ReadLayout(const std::string& path);

// The layout from --dictionary and --marker_length: no lines, and every id is accepted.
Layout MakeLayout(const std::string& dictionary, double marker_length_m);

// The length of the black square's outer edge, m.
constexpr double kMinMarkerLength_m = 1e-4, kMaxMarkerLength_m = 10.0;

// Throws InputError for a length beyond these; `what` names the key or option.
void CheckMarkerLength(double length_m, const std::string& what);

double MarkerLength(const Layout& layout, int marker_id);

// The ids that the layout names, ascending, each once.
std::vector<int> MarkerIds(const Layout& layout);

// The name of the part that holds the marker, or "" if none does.
std::string PartOfMarker(const Layout& layout, int marker_id);

using AdjacencyGraph = std::map<int, std::vector<int>>;
AdjacencyGraph BuildAdjacencyGraph(const Layout& layout);

// The number of edges from `marker_id` to every marker that can be reached from it.
std::map<int, int> TopologicalDistances(const AdjacencyGraph& graph, int marker_id);

}  // namespace velamap
