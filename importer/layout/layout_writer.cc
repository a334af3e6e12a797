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
  *out << YAML::Key << key << YAML::Value << YAML::BeginSeq;
  for (const MarkerLine& line : lines) {
    *out << YAML::Flow << YAML::BeginMap << YAML::Key << "name" << YAML::Value << line.name;
    *out << YAML::Key << "markers" << YAML::Value;
    EmitIds(line.marker_ids, out);
    *out << YAML::EndMap;
  }
  *out << YAML::EndSeq;
}

void EmitEdge(const char* key, const ClothEdge& edge, YAML::Emitter* out) {
  if (!edge.IsKnown()) return;
  *out << YAML::Key << key << YAML::Value;
  if (!edge.line.empty()) {
    *out << YAML::BeginMap << YAML::Key << "line" << YAML::Value << edge.line << YAML::EndMap;
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
  *out << YAML::Key << "edges" << YAML::Value << YAML::Flow << YAML::BeginMap;
  EmitEdge("luff", edges.luff, out);
  EmitEdge("leech", edges.leech, out);
  EmitEdge("foot", edges.foot, out);
  EmitEdge("head", edges.head, out);
  *out << YAML::EndMap
       << YAML::Comment("m, from the outer markers' centres to the edges of the cloth");
}

void EmitPart(const LayoutPart& part, YAML::Emitter* out) {
  *out << YAML::Key << part.name << YAML::Value << YAML::BeginMap;
  if (part.rigid) *out << YAML::Key << "rigid" << YAML::Value << true;
  EmitLines("horizontal", part.horizontal, out);
  EmitLines("vertical", part.vertical, out);
  if (!part.marker_ids.empty()) {
    *out << YAML::Key << "markers" << YAML::Value;
    EmitIds(part.marker_ids, out);
  }
  EmitEdges(part.edges, out);
  *out << YAML::EndMap;
}

void EmitDistance(const KnownDistance& distance, YAML::Emitter* out) {
  *out << YAML::Flow << YAML::BeginMap;
  *out << YAML::Key << "from" << YAML::Value << PointName(distance.marker_id1, distance.corner1);
  *out << YAML::Key << "to" << YAML::Value << PointName(distance.marker_id2, distance.corner2);
  *out << YAML::Key << "length" << YAML::Value << Number(distance.length_m);
  *out << YAML::Key << "sigma" << YAML::Value << Number(distance.sigma_m);
  if (distance.is_scale_bar) *out << YAML::Key << "use" << YAML::Value << "scale";
  *out << YAML::EndMap;
}

void EmitKnownPoint(const KnownPoint& point, YAML::Emitter* out) {
  *out << YAML::Flow << YAML::BeginMap;
  *out << YAML::Key << "at" << YAML::Value << PointName(point.marker_id, point.corner);
  for (std::size_t axis = 0; axis < point.x_m.size(); ++axis) {
    if (!point.x_m[axis]) continue;
    *out << YAML::Key << kAxisNames[axis] << YAML::Value << Number(*point.x_m[axis]);
  }
  *out << YAML::Key << "sigma" << YAML::Value << Number(point.sigma_m);
  if (point.is_check) *out << YAML::Key << "use" << YAML::Value << "check";
  *out << YAML::EndMap;
}

void EmitFrame(const FrameChoice& frame, YAML::Emitter* out) {
  *out << YAML::Key << "frame" << YAML::Value;
  if (frame.kind != FrameKind::kMarkers) {
    *out << FrameKeyword(frame.kind);
    return;
  }
  *out << YAML::Flow << YAML::BeginMap << YAML::Key << "origin" << YAML::Value << frame.origin_id
       << YAML::Key << "axis" << YAML::Value << frame.axis_id << YAML::Key << "plane" << YAML::Value
       << frame.plane_id << YAML::EndMap;
}

void EmitLayout(const Layout& layout, YAML::Emitter* out) {
  *out << YAML::BeginMap;
  *out << YAML::Key << "dictionary" << YAML::Value << layout.dictionary;
  *out << YAML::Key << "marker_length" << YAML::Value << Number(layout.marker_length_m)
       << YAML::Comment("m, outer edge of the black square");
  if (layout.drawn_length_m) {
    *out << YAML::Key << "drawn_length" << YAML::Value << Number(*layout.drawn_length_m)
         << YAML::Comment("m, the same on the sheets; stays if marker_length is corrected");
  }
  if (!layout.marker_lengths_m.empty()) {
    *out << YAML::Key << "marker_lengths" << YAML::Value << YAML::BeginMap;
    for (const auto& [id, length_m] : layout.marker_lengths_m) {
      *out << YAML::Key << id << YAML::Value << Number(length_m);
    }
    *out << YAML::EndMap;
  }
  if (layout.border_bits != 1) {
    *out << YAML::Key << "border_bits" << YAML::Value << layout.border_bits;
  }
  if (layout.HasMarkers()) {
    *out << YAML::Key << "parts" << YAML::Value << YAML::BeginMap;
    for (const LayoutPart& part : layout.parts) EmitPart(part, out);
    *out << YAML::EndMap;
  }
  if (layout.reference_part) {
    *out << YAML::Key << "reference_part" << YAML::Value << *layout.reference_part;
  }
  if (layout.frame) EmitFrame(*layout.frame, out);
  if (!layout.distances.empty()) {
    *out << YAML::Key << "distances" << YAML::Value << YAML::BeginSeq;
    for (const KnownDistance& distance : layout.distances) EmitDistance(distance, out);
    *out << YAML::EndSeq;
  }
  if (!layout.known_points.empty()) {
    *out << YAML::Key << "known_points" << YAML::Value << YAML::BeginSeq;
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
