// ReadLayout of importer/layout/layout.h: the YAML side of a layout.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/ids.h"
#include "importer/base/numbers.h"
#include "importer/base/text_file.h"
#include "importer/layout/layout.h"
#include "importer/layout/yaml_item.h"

namespace velamap {
namespace {

bool ParseMarkerId(const std::string& text, int* id) {
  return ParseNumber(text, id) && *id >= 0 && *id <= kMaxMarkerId;
}

int ReadMarkerId(const YamlItem& item) {
  int id = -1;
  if (!ParseMarkerId(item.Text(), &id)) {
    item.Fail(fmt::format("'{}' is no marker id; whole numbers from 0 to {} are expected",
                          item.Text(), kMaxMarkerId));
  }
  return id;
}

double ReadMetres(const YamlItem& item) {
  double length_m = 0.0;
  if (!ParseNumber(item.Text(), &length_m)) {
    item.Fail(
        fmt::format("'{}' is no number; a length in metres is expected, such as 0.1", item.Text()));
  }
  return length_m;
}

double ReadMarkerLength(const YamlItem& item) {
  const double length_m = ReadMetres(item);
  CheckMarkerLength(length_m,
                    fmt::format("{}:{}: {}", item.path, item.node.Mark().line + 1, item.key));
  return length_m;
}

std::vector<int> ReadMarkerIds(const YamlItem& list) {
  std::vector<int> ids;
  std::set<int> seen;
  ForEachElement(list, [&](const YamlItem& item) {
    ids.push_back(ReadMarkerId(item));
    if (!seen.insert(ids.back()).second) {
      item.Fail(fmt::format("marker {} stands twice on this line", ids.back()));
    }
  });
  return ids;
}

// Ids that one part holds, each with the part that named it first.
using PartOfId = std::map<int, std::string>;

void ClaimMarkers(const YamlItem& item, const std::string& part, const std::vector<int>& ids,
                  PartOfId* part_of_id) {
  for (const int id : ids) {
    const std::string& owner = part_of_id->emplace(id, part).first->second;
    if (owner != part) {
      item.Fail(
          fmt::format("marker {} is in part '{}' already; a marker is in one part", id, owner));
    }
  }
}

std::vector<MarkerLine> ReadLines(const YamlItem& list, const std::string& part,
                                  PartOfId* part_of_id) {
  std::vector<MarkerLine> lines;
  std::set<std::string> names;
  ForEachElement(list, [&](const YamlItem& item) {
    MarkerLine line;
    ReadMap(item, {{"name", [&](const YamlItem& value) { line.name = ReadString(value); }},
                   {"markers", [&](const YamlItem& value) {
                      line.marker_ids = ReadMarkerIds(value);
                      ClaimMarkers(value, part, line.marker_ids, part_of_id);
                    }}});
    if (line.name.empty()) item.Fail("the line needs a name, such as {name: h1, markers: [1, 2]}");
    if (!names.insert(line.name).second) item.Fail("a second line '" + line.name + "'");
    if (line.marker_ids.empty()) item.Fail("the line needs markers");
    lines.push_back(std::move(line));
  });
  return lines;
}

LayoutPart ReadPart(const YamlItem& item, const std::string& name, PartOfId* part_of_id) {
  LayoutPart part;
  part.name = name;
  ReadMap(item,
          {{"rigid", [&](const YamlItem& value) { part.rigid = ReadBool(value); }},
           {"horizontal",
            [&](const YamlItem& value) { part.horizontal = ReadLines(value, name, part_of_id); }},
           {"vertical",
            [&](const YamlItem& value) { part.vertical = ReadLines(value, name, part_of_id); }},
           {"markers", [&](const YamlItem& value) {
              part.marker_ids = ReadMarkerIds(value);
              ClaimMarkers(value, name, part.marker_ids, part_of_id);
            }}});
  if (part.horizontal.empty() && part.vertical.empty() && part.marker_ids.empty()) {
    item.Fail("the part has no markers");
  }
  return part;
}

std::vector<LayoutPart> ReadParts(const YamlItem& item) {
  std::vector<LayoutPart> parts;
  PartOfId part_of_id;
  ForEachKey(item, [&](const std::string& name, const YamlItem& value) {
    parts.push_back(ReadPart(value, name, &part_of_id));
  });
  if (parts.empty()) item.Fail("no part is named; leave the key out to accept every marker");
  return parts;
}

std::map<int, double> ReadMarkerLengths(const YamlItem& item) {
  std::map<int, double> lengths_m;
  ForEachKey(item, [&](const std::string& name, const YamlItem& value) {
    int id = -1;
    if (!ParseMarkerId(name, &id)) {
      value.Fail(fmt::format("'{}' is no marker id; {{id: length in m}} is expected", name));
    }
    lengths_m[id] = ReadMarkerLength(value);
  });
  return lengths_m;
}

int ReadBorderBits(const YamlItem& item) {
  int border_bits = 0;
  if (!ParseNumber(item.Text(), &border_bits) || border_bits < 1 || border_bits > 8) {
    item.Fail("the width of the black border in cells is expected, 1 to 8");
  }
  return border_bits;
}

double ReadPositiveMetres(const YamlItem& item) {
  const double length_m = ReadMetres(item);
  if (!std::isfinite(length_m) || length_m <= 0) {
    item.Fail(fmt::format("{} m is no length; a positive number of metres is expected", length_m));
  }
  return length_m;
}

// "12" is the centre of marker 12, "12.1" its corner 1.
void ReadMarkerPoint(const YamlItem& item, int* marker_id, int* corner) {
  const std::string text = item.Text();
  const std::size_t dot = text.find('.');
  *corner = 0;
  const bool is_corner =
      dot == std::string::npos || (ParseNumber(text.substr(dot + 1), corner) && *corner >= 1 &&
                                   *corner <= kNumCorners && text.size() == dot + 2);
  if (!is_corner || !ParseMarkerId(text.substr(0, dot), marker_id)) {
    item.Fail(
        fmt::format("'{}' is no point of a marker; its id stands for the centre, id.corner "
                    "(1 to 4) for a corner, such as 12 or 12.1",
                    text));
  }
}

// Whether the length takes part in the adjustment.
bool ReadUse(const YamlItem& item) {
  if (item.Text() != "check" && item.Text() != "scale") {
    item.Fail(
        fmt::format("'{}': check (compared with the result) or scale (takes part in the "
                    "adjustment) is expected",
                    item.Text()));
  }
  return item.Text() == "scale";
}

KnownDistance ReadDistance(const YamlItem& item) {
  KnownDistance distance;
  std::set<std::string> missing = {"from", "to", "length", "sigma"};
  ReadMap(item, {{"from",
                  [&](const YamlItem& v) {
                    ReadMarkerPoint(v, &distance.marker_id1, &distance.corner1);
                    missing.erase("from");
                  }},
                 {"to",
                  [&](const YamlItem& v) {
                    ReadMarkerPoint(v, &distance.marker_id2, &distance.corner2);
                    missing.erase("to");
                  }},
                 {"length",
                  [&](const YamlItem& v) {
                    distance.length_m = ReadPositiveMetres(v);
                    missing.erase("length");
                  }},
                 {"sigma",
                  [&](const YamlItem& v) {
                    distance.sigma_m = ReadPositiveMetres(v);
                    missing.erase("sigma");
                  }},
                 {"use", [&](const YamlItem& v) { distance.is_scale_bar = ReadUse(v); }}});
  if (!missing.empty()) {
    item.Fail(
        fmt::format("key '{}' is missing; expected is such as {{from: 12, to: 45, length: "
                    "2.315, sigma: 0.002}} (m)",
                    *missing.begin()));
  }
  if (distance.marker_id1 == distance.marker_id2 && distance.corner1 == distance.corner2) {
    item.Fail("from and to are the same point");
  }
  if (distance.sigma_m >= distance.length_m) {
    item.Fail(
        fmt::format("the sigma of {} m is no less than the length of {} m; both are in metres",
                    distance.sigma_m, distance.length_m));
  }
  return distance;
}

// `layout` has its parts.
std::vector<KnownDistance> ReadDistances(const YamlItem& list, const Layout& layout) {
  const std::vector<int> ids = MarkerIds(layout);
  std::vector<KnownDistance> distances;
  ForEachElement(list, [&](const YamlItem& item) {
    distances.push_back(ReadDistance(item));
    for (const int id : {distances.back().marker_id1, distances.back().marker_id2}) {
      if (!layout.HasMarkers() || std::binary_search(ids.begin(), ids.end(), id)) continue;
      item.Fail(fmt::format("marker {} is in no part; name it there or correct its id", id));
    }
  });
  if (distances.empty()) list.Fail("no distance is given; leave the key out");
  return distances;
}

FrameChoice ReadFrameMarkers(const YamlItem& map) {
  FrameChoice frame;
  frame.kind = FrameKind::kMarkers;
  ReadMap(map, {{"origin", [&](const YamlItem& v) { frame.origin_id = ReadMarkerId(v); }},
                {"axis", [&](const YamlItem& v) { frame.axis_id = ReadMarkerId(v); }},
                {"plane", [&](const YamlItem& v) { frame.plane_id = ReadMarkerId(v); }}});
  for (const auto& [id, key] :
       {std::pair(frame.origin_id, "origin"), std::pair(frame.axis_id, "axis"),
        std::pair(frame.plane_id, "plane")}) {
    if (id < 0) {
      map.Fail(
          fmt::format("key '{}' is missing; expected is such as {{origin: 12, axis: 15, "
                      "plane: 40}} (marker ids)",
                      key));
    }
  }
  if (std::set<int>{frame.origin_id, frame.axis_id, frame.plane_id}.size() < 3) {
    map.Fail("origin, axis and plane have to be three different markers");
  }
  return frame;
}

// `layout` has its parts and its reference part.
FrameChoice ReadFrame(const YamlItem& item, const Layout& layout) {
  if (item.node.IsMap()) {
    const FrameChoice frame = ReadFrameMarkers(item);
    const std::vector<int> ids = MarkerIds(layout);
    for (const int id : {frame.origin_id, frame.axis_id, frame.plane_id}) {
      if (!layout.HasMarkers() || std::binary_search(ids.begin(), ids.end(), id)) continue;
      item.Fail(fmt::format("marker {} is in no part; name it there or correct its id", id));
    }
    return frame;
  }
  FrameChoice frame;
  if (!ParseFrameKeyword(item.Text(), &frame.kind)) {
    item.Fail(
        fmt::format("'{}' is no frame; reference_part, lines, camera, or three markers such "
                    "as {{origin: 12, axis: 15, plane: 40}} are expected",
                    item.Text()));
  }
  if (frame.kind == FrameKind::kReferencePart && !layout.reference_part) {
    item.Fail("the frame of the reference part needs the key 'reference_part'");
  }
  const bool has_lines =
      std::any_of(layout.parts.begin(), layout.parts.end(),
                  [](const LayoutPart& part) { return !part.horizontal.empty(); });
  if (frame.kind == FrameKind::kLines && !has_lines) {
    item.Fail("the frame by lines needs a part with horizontal lines");
  }
  return frame;
}

std::string ReadDictionaryName(const YamlItem& item) {
  const std::string name = ReadString(item);
  const std::filesystem::path file = std::filesystem::path(item.path).parent_path() / name;
  std::error_code ignored;
  const bool is_file = std::filesystem::is_regular_file(file, ignored);
  // What looks like a file is reported with the folder in which it was looked for.
  const bool looks_like_file = name.find_first_of("./") != std::string::npos;
  return is_file || looks_like_file ? file.string() : name;
}

}  // namespace

Layout ReadLayout(const std::string& path) {
  const std::string text = ReadTextFile(path, "layout file (--layout_path)");
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& exception) {
    FailYaml(path, exception.mark, "no valid YAML: " + exception.msg);
  }
  const YamlItem top{path, root, ""};
  Layout layout;
  std::optional<YamlItem> reference, distances, frame;
  ReadMap(
      top,
      {{"dictionary", [&](const YamlItem& v) { layout.dictionary = ReadDictionaryName(v); }},
       {"marker_length", [&](const YamlItem& v) { layout.marker_length_m = ReadMarkerLength(v); }},
       {"marker_lengths",
        [&](const YamlItem& v) { layout.marker_lengths_m = ReadMarkerLengths(v); }},
       {"border_bits", [&](const YamlItem& v) { layout.border_bits = ReadBorderBits(v); }},
       {"parts", [&](const YamlItem& v) { layout.parts = ReadParts(v); }},
       {"reference_part", [&](const YamlItem& v) { reference.emplace(v); }},
       {"distances", [&](const YamlItem& v) { distances.emplace(v); }},
       {"frame", [&](const YamlItem& v) { frame.emplace(v); }}});
  if (layout.dictionary.empty()) top.Fail("key 'dictionary' is missing, such as DICT_4X4_50");
  if (layout.marker_length_m == 0.0) top.Fail("key 'marker_length' is missing (metres)");
  if (reference) {
    layout.reference_part = ReadString(*reference);
    bool known = false;
    for (const LayoutPart& part : layout.parts) known |= part.name == *layout.reference_part;
    if (!known) reference->Fail("there is no part '" + *layout.reference_part + "'");
  }
  if (distances) layout.distances = ReadDistances(*distances, layout);
  if (frame) layout.frame = ReadFrame(*frame, layout);
  return layout;
}

}  // namespace velamap
