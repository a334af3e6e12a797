#include "importer/layout/layout_items.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "importer/base/ids.h"
#include "importer/base/numbers.h"
#include "importer/text/id_ranges.h"

namespace velamap {
namespace {

enum class EdgeKind { kSide, kEnd };  // luff and leech; foot and head

double ReadPositiveMetres(const YamlItem& item) {
  constexpr double kMaxLength_m = 1e5;
  const double length_m = ReadMetres(item);
  if (!(length_m > 0 && length_m <= kMaxLength_m)) {
    item.Fail(fmt::format("{} m is not a length; expected a positive number of metres, up to {:g}",
                          length_m, kMaxLength_m));
  }
  return length_m;
}

KnownDistance ReadDistance(const YamlItem& item) {
  KnownDistance distance;
  ReadMap(
      item,
      {{"from",
        [&](const YamlItem& v) { ReadMarkerPoint(v, &distance.marker_id1, &distance.corner1); }},
       {"to",
        [&](const YamlItem& v) { ReadMarkerPoint(v, &distance.marker_id2, &distance.corner2); }},
       {"length", [&](const YamlItem& v) { distance.length_m = ReadPositiveMetres(v); }},
       {"sigma", [&](const YamlItem& v) { distance.sigma_m = ReadPositiveMetres(v); }},
       {"use",
        [&](const YamlItem& v) {
          distance.is_scale_bar = TakesPart(v, "scale", "takes part in the adjustment");
        }}},
      {"from", "length", "sigma", "to"}, "{from: 12, to: 45, length: 2.315, sigma: 0.002} (m)");
  if (distance.marker_id1 == distance.marker_id2 && distance.corner1 == distance.corner2) {
    item.Fail("from and to are the same point");
  }
  if (distance.sigma_m >= distance.length_m) {
    item.Fail(fmt::format("the sigma of {} m is not below the length of {} m; both are in metres",
                          distance.sigma_m, distance.length_m));
  }
  return distance;
}

double ReadOffset(const YamlItem& item) {
  constexpr double kMaxOffset_m = 200.0;  // the longest luff that a placement allows
  const double offset_m = ReadMetres(item);
  if (!(offset_m >= 0 && offset_m <= kMaxOffset_m)) {
    item.Fail(fmt::format("{} m is out of range; give 0 to {} m", offset_m, kMaxOffset_m));
  }
  return offset_m;
}

// The line of luff or leech must be vertical; that of foot or head must be the first or the last
// horizontal one. The surface ends at it, or `offset` beyond.
void CheckEdgeLine(const YamlItem& item, const std::string& name, const LayoutPart& part,
                   EdgeKind kind) {
  const auto is_it = [&](const MarkerLine& line) { return line.name == name; };
  if (kind == EdgeKind::kEnd && !is_it(part.horizontal.front()) && !is_it(part.horizontal.back())) {
    const std::string first = "'" + part.horizontal.front().name + "'";
    const std::string last = "'" + part.horizontal.back().name + "'";
    item.Fail(
        fmt::format("'{}' is neither the first nor the last horizontal line; expected {}, "
                    "or {{points: [...]}} for markers on no line",
                    name, first == last ? first : first + " or " + last));
  }
  if (kind == EdgeKind::kSide && std::none_of(part.vertical.begin(), part.vertical.end(), is_it)) {
    item.Fail(
        fmt::format("there is no vertical line '{}'; expected a distance in m, a list of them, "
                    "{{line: name}} or {{points: [...]}}",
                    name));
  }
}

std::vector<CornerId> ReadEdgePoints(const YamlItem& list, const LayoutPart& part, EdgeKind kind) {
  const std::set<int> ids = MarkerIds(part);
  std::vector<CornerId> points;
  ForEachElement(list, [&](const YamlItem& item) {
    CornerId point;
    ReadMarkerPoint(item, &point.marker_id, &point.corner);
    const int id = point.marker_id;
    if (ids.count(id) == 0) {
      item.Fail(fmt::format("marker {} is not in the part; name it there or correct its id", id));
    }
    if (std::count(points.begin(), points.end(), point) > 0) {
      item.Fail(fmt::format("point {} is named twice", PointName(id, point.corner)));
    }
    for (const MarkerLine& line : part.horizontal) {
      const bool is_on = std::count(line.marker_ids.begin(), line.marker_ids.end(), id) > 0;
      if (kind == EdgeKind::kSide || point.corner != 0 || !is_on) continue;
      item.Fail(
          fmt::format("the centre of marker {} is on the line {}, which cannot also be the edge; "
                      "name a corner of it, such as {}, or {{line: {}}}",
                      id, line.name, PointName(id, kNumCorners), line.name));
    }
    points.push_back(point);
  });
  if (points.size() < 2) list.Fail("one point is no edge; name two or more, such as [12, 13.4]");
  return points;
}

// Reads what lies along the edge.
ClothEdge ReadPlacesOfEdge(const YamlItem& item, const LayoutPart& part, EdgeKind kind) {
  ClothEdge edge;
  ReadMap(item,
          {{"line", [&](const YamlItem& v) { edge.line = ReadString(v); }},
           {"points", [&](const YamlItem& v) { edge.points = ReadEdgePoints(v, part, kind); }},
           {"offset", [&](const YamlItem& v) { edge.offsets_m = {ReadOffset(v)}; }}});
  if (edge.line.empty() == edge.points.empty()) {
    item.Fail("one of line and points is expected, such as {line: v1} or {points: [12, 13.4]}");
  }
  if (!edge.line.empty()) CheckEdgeLine(item, edge.line, part, kind);
  return edge;
}

ClothEdge ReadEdge(const YamlItem& item, const LayoutPart& part, EdgeKind kind) {
  if (item.node.IsMap()) return ReadPlacesOfEdge(item, part, kind);
  ClothEdge edge;
  if (item.node.IsScalar()) {
    edge.offsets_m = {ReadOffset(item)};
    return edge;
  }
  if (kind == EdgeKind::kEnd) {
    item.Fail("one distance in m is expected, such as 0.12, or {line: name}, or {points: [...]}");
  }
  ForEachElement(item, [&](const YamlItem& v) { edge.offsets_m.push_back(ReadOffset(v)); });
  if (edge.offsets_m.size() != part.horizontal.size()) {
    item.Fail(fmt::format("{} distances for {} horizontal lines; give one for each, or one for all",
                          edge.offsets_m.size(), part.horizontal.size()));
  }
  return edge;
}

int ReadMarkerId(const YamlItem& item) {
  int id = -1;
  if (!ParseMarkerId(item.Text(), &id)) {
    item.Fail(fmt::format("'{}' is not a marker id; expected a whole number from 0 to {}",
                          item.Text(), kMaxMarkerId));
  }
  return id;
}

FrameChoice ReadFrameMarkers(const YamlItem& map) {
  FrameChoice frame;
  frame.kind = FrameKind::kMarkers;
  ReadMap(map,
          {{"origin", [&](const YamlItem& v) { frame.origin_id = ReadMarkerId(v); }},
           {"axis", [&](const YamlItem& v) { frame.axis_id = ReadMarkerId(v); }},
           {"plane", [&](const YamlItem& v) { frame.plane_id = ReadMarkerId(v); }}},
          {"origin", "axis", "plane"}, "{origin: 12, axis: 15, plane: 40} (marker ids)");
  if (std::set<int>{frame.origin_id, frame.axis_id, frame.plane_id}.size() < 3) {
    map.Fail("origin, axis and plane have to be three different markers");
  }
  return frame;
}

}  // namespace

double ReadMetres(const YamlItem& item) {
  double length_m = 0.0;
  if (!ParseNumber(item.Text(), &length_m)) {
    item.Fail(
        fmt::format("'{}' is not a number; expected a length in metres, such as 0.1", item.Text()));
  }
  return length_m;
}

bool TakesPart(const YamlItem& item, const std::string& word, const std::string& meaning) {
  if (item.Text() != word && item.Text() != "check") {
    item.Fail(fmt::format("'{}': {} ({}) or check (compared with the result) is expected",
                          item.Text(), word, meaning));
  }
  return item.Text() == word;
}

void CheckMarkersAreNamed(const std::vector<int>& marker_ids, const Layout& layout,
                          const YamlItem& item) {
  if (!layout.HasMarkers()) return;
  const std::vector<int> named_ids = MarkerIds(layout);
  for (const int id : marker_ids) {
    if (std::binary_search(named_ids.begin(), named_ids.end(), id)) continue;
    item.Fail(fmt::format("marker {} is in no part; name it there or correct its id", id));
  }
}

void ReadMarkerPoint(const YamlItem& item, int* marker_id, int* corner) {
  const std::string text = item.Text();
  const std::size_t dot = text.find('.');
  *corner = 0;
  const bool is_corner =
      dot == std::string::npos || (ParseNumber(text.substr(dot + 1), corner) && *corner >= 1 &&
                                   *corner <= kNumCorners && text.size() == dot + 2);
  if (!is_corner || !ParseMarkerId(text.substr(0, dot), marker_id)) {
    item.Fail(
        fmt::format("'{}' is not a point of a marker; expected the id for its centre, or id.corner "
                    "(1 to 4) for a corner, such as 12 or 12.1",
                    text));
  }
}

ClothEdges ReadEdges(const YamlItem& item, const LayoutPart& part) {
  if (part.horizontal.empty()) item.Fail("the edges of a part without horizontal lines are unused");
  ClothEdges edges;
  const auto read = [&](ClothEdge* edge, EdgeKind kind) {
    return [edge, kind, &part](const YamlItem& v) { *edge = ReadEdge(v, part, kind); };
  };
  ReadMap(item, {{"luff", read(&edges.luff, EdgeKind::kSide)},
                 {"leech", read(&edges.leech, EdgeKind::kSide)},
                 {"foot", read(&edges.foot, EdgeKind::kEnd)},
                 {"head", read(&edges.head, EdgeKind::kEnd)}});
  if (!edges.foot.line.empty() && edges.foot.line == edges.head.line) {
    item.Fail(fmt::format("foot and head are the same line '{}'", edges.foot.line));
  }
  return edges;
}

std::vector<KnownDistance> ReadDistances(const YamlItem& list, const Layout& layout) {
  std::vector<KnownDistance> distances;
  ForEachElement(list, [&](const YamlItem& item) {
    distances.push_back(ReadDistance(item));
    CheckMarkersAreNamed({distances.back().marker_id1, distances.back().marker_id2}, layout, item);
  });
  if (distances.empty()) list.Fail("no distance is given; leave the key out");
  return distances;
}

FrameChoice ReadFrame(const YamlItem& item, const Layout& layout) {
  if (item.node.IsMap()) {
    const FrameChoice frame = ReadFrameMarkers(item);
    CheckMarkersAreNamed({frame.origin_id, frame.axis_id, frame.plane_id}, layout, item);
    return frame;
  }
  FrameChoice frame;
  if (!ParseFrameKeyword(item.Text(), &frame.kind)) {
    item.Fail(
        fmt::format("'{}' is not a frame; expected known_points, reference_part, lines, camera, or "
                    "three markers such as {{origin: 12, axis: 15, plane: 40}}",
                    item.Text()));
  }
  if (frame.kind == FrameKind::kKnownPoints) {
    const std::string lack = WhatDatumLacks(layout.known_points);
    if (!lack.empty()) {
      item.Fail("the frame of the known points needs more of them (key 'known_points'): " + lack);
    }
  }
  if (frame.kind == FrameKind::kReferencePart && !layout.reference_part) {
    item.Fail("the frame of the reference part needs the key 'reference_part'");
  }
  if (frame.kind == FrameKind::kLines && FirstPartWithLines(layout) == nullptr) {
    item.Fail("the frame by lines needs a part with horizontal lines");
  }
  return frame;
}

}  // namespace velamap
