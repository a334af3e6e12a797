// Implements ReadLayout() of layout.h.

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/ids.h"
#include "importer/base/log.h"
#include "importer/base/numbers.h"
#include "importer/layout/layout.h"
#include "importer/layout/layout_items.h"
#include "importer/layout/yaml_item.h"
#include "importer/text/id_ranges.h"
#include "importer/text/nearest_name.h"
#include "importer/text/text_file.h"

namespace velamap {
namespace {

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
    const auto range = ParseIdRange(item.Text());
    if (!range) {
      item.Fail(
          fmt::format("'{}' is not a marker id or a range of them such as 0-16; expected whole "
                      "numbers from 0 to {}",
                      item.Text(), kMaxMarkerId));
    }
    for (const int id : *range) {
      ids.push_back(id);
      if (seen.insert(id).second) continue;
      item.Fail(fmt::format("marker {} is named twice in this list", id));
    }
  });
  return ids;
}

// The first part that named each id.
using PartOfId = std::map<int, std::string>;

void ClaimMarkers(const YamlItem& item, const std::string& part, const std::vector<int>& ids,
                  PartOfId* part_of_id) {
  for (const int id : ids) {
    const std::string& owner = part_of_id->emplace(id, part).first->second;
    if (owner != part) {
      item.Fail(fmt::format("marker {} is in part '{}' already; a marker belongs to one part", id,
                            owner));
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

// A marker on two horizontal lines would pull the surface from one of them to the other. It may be
// on a horizontal line and on vertical ones, which meet there.
void CheckOneLineEach(const YamlItem& list, const std::vector<MarkerLine>& lines) {
  struct Place {
    const MarkerLine* line;
    int line_of_file;
  };
  std::map<int, Place> place_of_id;
  auto line = lines.begin();
  ForEachElement(list, [&](const YamlItem& item) {
    const Place here{&*line++, item.node.Mark().line + 1};
    for (const int id : here.line->marker_ids) {
      const auto [first, is_new] = place_of_id.emplace(id, here);
      if (is_new) continue;
      item.Fail(fmt::format(
          "marker {} is on line '{}' and on line '{}' ({}:{}); a marker is on one "
          "horizontal line: correct its id where it is wrong",
          id, here.line->name, first->second.line->name, item.path, first->second.line_of_file));
    }
  });
}

LayoutPart ReadPart(const YamlItem& item, const std::string& name, PartOfId* part_of_id) {
  LayoutPart part;
  part.name = name;
  std::optional<YamlItem> edges;
  ReadMap(item,
          {{"rigid", [&](const YamlItem& value) { part.rigid = ReadBool(value); }},
           {"horizontal",
            [&](const YamlItem& value) {
              part.horizontal = ReadLines(value, name, part_of_id);
              CheckOneLineEach(value, part.horizontal);
            }},
           {"vertical",
            [&](const YamlItem& value) { part.vertical = ReadLines(value, name, part_of_id); }},
           {"edges", [&](const YamlItem& value) { edges.emplace(value); }},
           {"markers", [&](const YamlItem& value) {
              part.marker_ids = ReadMarkerIds(value);
              ClaimMarkers(value, name, part.marker_ids, part_of_id);
            }}});
  if (part.horizontal.empty() && part.vertical.empty() && part.marker_ids.empty()) {
    item.Fail("the part has no markers");
  }
  if (edges) part.edges = ReadEdges(*edges, part);
  return part;
}

std::vector<LayoutPart> ReadParts(const YamlItem& item) {
  std::vector<LayoutPart> parts;
  PartOfId part_of_id;
  ForEachKey(item, [&](const std::string& name, const YamlItem& value) {
    parts.push_back(ReadPart(value, CheckedName(name, item), &part_of_id));
  });
  if (parts.empty()) item.Fail("no part is named; leave the key out to accept every marker");
  return parts;
}

void CheckIsPart(const YamlItem& item, const std::string& name,
                 const std::vector<LayoutPart>& parts) {
  std::vector<std::string> known;
  for (const LayoutPart& part : parts) known.push_back(part.name);
  if (std::count(known.begin(), known.end(), name) > 0) return;
  item.Fail(fmt::format("there is no part '{}'; {}known here: {}", name, DidYouMean(name, known),
                        known.empty() ? "none" : fmt::format("{}", fmt::join(known, " "))));
}

std::map<int, double> ReadMarkerLengths(const YamlItem& item) {
  std::map<int, double> lengths_m;
  ForEachKey(item, [&](const std::string& name, const YamlItem& value) {
    const auto range = ParseIdRange(name);
    if (!range) {
      value.Fail(fmt::format(
          "'{}' is not a marker id or a range of them; expected {{id: length in m}}", name));
    }
    const double length_m = ReadMarkerLength(value);
    for (const int id : *range) {
      if (lengths_m.emplace(id, length_m).second) continue;
      value.Fail(fmt::format("marker {} is given a second length", id));
    }
  });
  return lengths_m;
}

// Markers that no part names are ignored, so their lengths have no effect.
void WarnOfUnusedLengths(const YamlItem& item, const Layout& layout) {
  if (!layout.HasMarkers()) return;
  const std::vector<int> ids = MarkerIds(layout);
  ForEachKey(item, [&](const std::string& name, const YamlItem& value) {
    const std::vector<int> range = *ParseIdRange(name);
    const bool names_one = std::any_of(range.begin(), range.end(), [&](int id) {
      return std::binary_search(ids.begin(), ids.end(), id);
    });
    if (names_one) return;
    LogWarning("{}:{}: {}: no part names marker {}, so its length changes nothing", value.path,
               value.node.Mark().line + 1, value.key, name);
  });
}

int ReadBorderBits(const YamlItem& item) {
  int border_bits = 0;
  if (!ParseNumber(item.Text(), &border_bits) || border_bits < 1 || border_bits > 8) {
    item.Fail("the width of the black border in cells is expected, 1 to 8");
  }
  return border_bits;
}

std::string ReadDictionaryName(const YamlItem& item) {
  const std::string name = ReadString(item);
  const std::filesystem::path file = std::filesystem::path(item.path).parent_path() / name;
  const bool is_file = IsRegularFile(file);
  // If the file is missing, the error should name the folder in which it was expected.
  const bool looks_like_file = name.find_first_of("./") != std::string::npos;
  return is_file || looks_like_file ? file.string() : name;
}

// yaml-cpp reads only the first document and would silently ignore others.
void CheckSingleDocument(const std::string& path, const std::string& text) {
  std::istringstream lines(text);
  bool has_content = false, has_ended = false;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::string marker = line.substr(0, 3);
    const bool is_marker = (marker == "---" || marker == "...") &&
                           (line.size() == 3 || std::isspace(static_cast<unsigned char>(line[3])));
    const std::size_t first =
        is_marker ? line.find_first_not_of(" \t\r", 3) : line.find_first_not_of(" \t\r");
    if (is_marker) has_ended = has_content;
    if (first == std::string::npos || line[first] == '#' || line[first] == '%') continue;
    if (has_ended) {
      throw InputError(fmt::format(
          "{}:{}: a second document begins here; put all keys into the first one", path, number));
    }
    has_content = true;
  }
}

}  // namespace

Layout ReadLayout(const std::string& path) {
  const std::string text = ReadTextFile(path, "layout file (--layout_path)");
  CheckUtf8(text, path);
  CheckSingleDocument(path, text);
  const YamlItem top{path, LoadYaml(path, text), ""};
  Layout layout;
  std::optional<YamlItem> lengths, reference, distances, known_points, frame;
  ReadMap(
      top,
      {{"dictionary", [&](const YamlItem& v) { layout.dictionary = ReadDictionaryName(v); }},
       {"marker_length", [&](const YamlItem& v) { layout.marker_length_m = ReadMarkerLength(v); }},
       {"marker_lengths", [&](const YamlItem& v) { lengths.emplace(v); }},
       {"drawn_length", [&](const YamlItem& v) { layout.drawn_length_m = ReadMarkerLength(v); }},
       {"border_bits", [&](const YamlItem& v) { layout.border_bits = ReadBorderBits(v); }},
       {"parts", [&](const YamlItem& v) { layout.parts = ReadParts(v); }},
       {"reference_part", [&](const YamlItem& v) { reference.emplace(v); }},
       {"distances", [&](const YamlItem& v) { distances.emplace(v); }},
       {"known_points", [&](const YamlItem& v) { known_points.emplace(v); }},
       {"frame", [&](const YamlItem& v) { frame.emplace(v); }}});
  if (layout.dictionary.empty()) top.Fail("key 'dictionary' is missing, such as DICT_4X4_50");
  if (layout.marker_length_m == 0.0) top.Fail("key 'marker_length' is missing (metres)");
  if (lengths) {
    layout.marker_lengths_m = ReadMarkerLengths(*lengths);
    WarnOfUnusedLengths(*lengths, layout);
  }
  if (reference) {
    layout.reference_part = ReadString(*reference);
    CheckIsPart(*reference, *layout.reference_part, layout.parts);
  }
  if (distances) layout.distances = ReadDistances(*distances, layout);
  if (known_points) layout.known_points = ReadKnownPoints(*known_points, layout);
  if (frame) layout.frame = ReadFrame(*frame, layout);
  return layout;
}

}  // namespace velamap
