#include "importer/layout/layout_writer.h"

#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

namespace velamap {
namespace {

// Writes the fewest digits that give the same number when they are read.
std::string Number(double value) { return fmt::format("{}", value); }

void EmitIds(const std::vector<int>& ids, YAML::Emitter* out) {
  *out << YAML::Flow << YAML::BeginSeq;
  for (const int id : ids) *out << id;
  *out << YAML::EndSeq;
}

void EmitLines(const char* key, const std::vector<MarkerLine>& lines, YAML::Emitter* out) {
  if (lines.empty()) return;
  *out << key << YAML::BeginSeq;
  for (const MarkerLine& line : lines) {
    *out << YAML::Flow << YAML::BeginMap << "name" << line.name << "markers";
    EmitIds(line.marker_ids, out);
    *out << YAML::EndMap;
  }
  *out << YAML::EndSeq;
}

void EmitEdge(const char* key, const ClothEdge& edge, YAML::Emitter* out) {
  if (!edge.IsKnown()) return;
  *out << key;
  if (edge.HasPlaces()) {
    *out << YAML::BeginMap;
    if (!edge.line.empty()) *out << "line" << edge.line;
    if (!edge.points.empty()) {
      *out << "points" << YAML::BeginSeq;
      for (const CornerId& point : edge.points) *out << PointName(point.marker_id, point.corner);
      *out << YAML::EndSeq;
    }
    if (!edge.offsets_m.empty()) *out << "offset" << Number(edge.offsets_m.front());
    *out << YAML::EndMap;
  } else if (edge.offsets_m.size() == 1) {
    *out << Number(edge.offsets_m.front());
  } else {
    *out << YAML::BeginSeq;
    for (const double offset_m : edge.offsets_m) *out << Number(offset_m);
    *out << YAML::EndSeq;
  }
}

void EmitEdges(const ClothEdges& edges, YAML::Emitter* out) {
  if (!edges.luff.IsKnown() && !edges.leech.IsKnown() && !edges.foot.IsKnown() &&
      !edges.head.IsKnown()) {
    return;
  }
  *out << "edges" << YAML::Flow << YAML::BeginMap;
  EmitEdge("luff", edges.luff, out);
  EmitEdge("leech", edges.leech, out);
  EmitEdge("foot", edges.foot, out);
  EmitEdge("head", edges.head, out);
  *out << YAML::EndMap
       << YAML::Comment("m, from the outer markers' centres to the edges of the cloth");
}

void EmitPart(const LayoutPart& part, YAML::Emitter* out) {
  *out << part.name << YAML::BeginMap;
  if (part.rigid) *out << "rigid" << true;
  EmitLines("horizontal", part.horizontal, out);
  EmitLines("vertical", part.vertical, out);
  if (!part.marker_ids.empty()) {
    *out << "markers";
    EmitIds(part.marker_ids, out);
  }
  EmitEdges(part.edges, out);
  *out << YAML::EndMap;
}

void EmitDistance(const KnownDistance& distance, YAML::Emitter* out) {
  *out << YAML::Flow << YAML::BeginMap;
  *out << "from" << PointName(distance.marker_id1, distance.corner1);
  *out << "to" << PointName(distance.marker_id2, distance.corner2);
  *out << "length" << Number(distance.length_m);
  *out << "sigma" << Number(distance.sigma_m);
  if (distance.is_scale_bar) *out << "use" << std::string("scale");
  *out << YAML::EndMap;
}

void EmitKnownPoint(const KnownPoint& point, YAML::Emitter* out) {
  *out << YAML::Flow << YAML::BeginMap;
  *out << "at" << PointName(point.marker_id, point.corner);
  for (std::size_t axis = 0; axis < point.x_m.size(); ++axis) {
    if (!point.x_m[axis]) continue;
    *out << kAxisNames[axis] << Number(*point.x_m[axis]);
  }
  *out << "sigma" << Number(point.sigma_m);
  if (point.is_check) *out << "use" << std::string("check");
  *out << YAML::EndMap;
}

void EmitFrame(const FrameChoice& frame, YAML::Emitter* out) {
  *out << "frame";
  if (frame.kind != FrameKind::kMarkers) {
    *out << FrameKeyword(frame.kind);
    return;
  }
  *out << YAML::Flow << YAML::BeginMap << "origin" << frame.origin_id << "axis" << frame.axis_id
       << "plane" << frame.plane_id << YAML::EndMap;
}

void EmitLayout(const Layout& layout, YAML::Emitter* out) {
  *out << YAML::BeginMap;
  *out << "dictionary" << layout.dictionary;
  *out << "marker_length" << Number(layout.marker_length_m)
       << YAML::Comment("m, outer edge of the black square, without the spread of ink");
  if (layout.drawn_length_m) {
    *out << "drawn_length" << Number(*layout.drawn_length_m)
         << YAML::Comment("m, the same on the sheets; stays if marker_length is corrected");
  }
  if (!layout.marker_lengths_m.empty()) {
    *out << "marker_lengths" << YAML::BeginMap;
    for (const auto& [id, length_m] : layout.marker_lengths_m) {
      *out << id << Number(length_m);
    }
    *out << YAML::EndMap;
  }
  if (layout.border_bits != 1) {
    *out << "border_bits" << layout.border_bits;
  }
  if (layout.HasMarkers()) {
    *out << "parts" << YAML::BeginMap;
    for (const LayoutPart& part : layout.parts) EmitPart(part, out);
    *out << YAML::EndMap;
  }
  if (layout.reference_part) {
    *out << "reference_part" << *layout.reference_part;
  }
  if (layout.frame) EmitFrame(*layout.frame, out);
  if (!layout.distances.empty()) {
    *out << "distances" << YAML::BeginSeq;
    for (const KnownDistance& distance : layout.distances) EmitDistance(distance, out);
    *out << YAML::EndSeq;
  }
  if (!layout.known_points.empty()) {
    *out << "known_points" << YAML::BeginSeq;
    for (const KnownPoint& point : layout.known_points) EmitKnownPoint(point, out);
    *out << YAML::EndSeq;
  }
  *out << YAML::EndMap;
}

}  // namespace

std::string LayoutText(const Layout& layout, const std::string& comment) {
  std::string text;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) text += "# " + line + "\n";
  YAML::Emitter out;
  EmitLayout(layout, &out);
  return text + out.c_str() + "\n";
}

}  // namespace velamap
