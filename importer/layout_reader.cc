// ReadLayout of importer/layout.h: the YAML side of a layout.

#include <charconv>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "importer/error.h"
#include "importer/ids.h"
#include "importer/layout.h"
#include "importer/text_file.h"

namespace velamap {
namespace {

[[noreturn]] void Fail(const std::string& path, const YAML::Mark& mark,
                       const std::string& message) {
  if (mark.is_null()) throw InputError(fmt::format("{}: {}", path, message));
  throw InputError(fmt::format("{}:{}: {}", path, mark.line + 1, message));
}

// A node, the file it comes from and its key from the top, as errors name it.
struct Item {
  const std::string& path;
  YAML::Node node;
  std::string key;

  [[noreturn]] void Fail(const std::string& message) const {
    velamap::Fail(path, node.Mark(), key.empty() ? message : key + ": " + message);
  }
};

using KeyHandlers = std::map<std::string, std::function<void(const Item&)>>;

// Calls handle(name, value) for every key of a map, each key once.
void ForEachKey(const Item& map,
                const std::function<void(const std::string&, const Item&)>& handle) {
  if (!map.node.IsMap()) map.Fail("a map of 'key: value' is expected");
  std::set<std::string> seen;
  for (const auto& entry : map.node) {
    if (!entry.first.IsScalar()) Fail(map.path, entry.first.Mark(), "a plain key is expected");
    const std::string name = entry.first.Scalar();
    const std::string key = map.key.empty() ? name : map.key + "." + name;
    if (!seen.insert(name).second) Fail(map.path, entry.first.Mark(), key + ": stands twice");
    // An empty value has no mark of its own in yaml-cpp; the key's line serves.
    if (entry.second.IsNull()) Fail(map.path, entry.first.Mark(), key + ": has no value");
    handle(name, Item{map.path, entry.second, key});
  }
}

void ReadMap(const Item& map, const KeyHandlers& handlers) {
  ForEachKey(map, [&](const std::string& name, const Item& value) {
    const auto handler = handlers.find(name);
    if (handler == handlers.end()) {
      std::string known;
      for (const auto& [known_name, function] : handlers) known += " " + known_name;
      value.Fail("unknown key; known here:" + known);
    }
    handler->second(value);
  });
}

std::string ReadString(const Item& item) {
  if (!item.node.IsScalar() || item.node.Scalar().empty()) item.Fail("a name is expected");
  return item.node.Scalar();
}

// yaml-cpp would read 010 as octal and skip what follows a number; a marker's label is decimal.
template <typename T>
bool ParseNumber(const std::string& text, T* value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *value);
  return error == std::errc() && end == text.data() + text.size();
}

int ReadMarkerId(const Item& item) {
  int id = -1;
  const bool number = item.node.IsScalar() && ParseNumber(item.node.Scalar(), &id);
  if (!number || id < 0 || id > kMaxMarkerId) {
    item.Fail(fmt::format("'{}' is no marker id; whole numbers from 0 to {} are expected",
                          item.node.IsScalar() ? item.node.Scalar() : "", kMaxMarkerId));
  }
  return id;
}

double ReadLength(const Item& item) {
  double length_m = 0.0;
  if (!item.node.IsScalar() || !ParseNumber(item.node.Scalar(), &length_m)) {
    item.Fail(fmt::format("'{}' is no number; a length in metres is expected, such as 0.1",
                          item.node.IsScalar() ? item.node.Scalar() : ""));
  }
  CheckMarkerLength(length_m,
                    fmt::format("{}:{}: {}", item.path, item.node.Mark().line + 1, item.key));
  return length_m;
}

bool ReadBool(const Item& item) {
  bool value = false;
  if (!item.node.IsScalar() || !YAML::convert<bool>::decode(item.node, value)) {
    item.Fail("true or false is expected");
  }
  return value;
}

void ForEachElement(const Item& list, const std::function<void(const Item&)>& handle) {
  if (!list.node.IsSequence()) list.Fail("a list is expected, such as [1, 2, 3]");
  for (std::size_t i = 0; i < list.node.size(); ++i) {
    handle(Item{list.path, list.node[i], fmt::format("{}[{}]", list.key, i)});
  }
}

std::vector<int> ReadMarkerIds(const Item& list) {
  std::vector<int> ids;
  std::set<int> seen;
  ForEachElement(list, [&](const Item& item) {
    ids.push_back(ReadMarkerId(item));
    if (!seen.insert(ids.back()).second) {
      item.Fail(fmt::format("marker {} stands twice on this line", ids.back()));
    }
  });
  return ids;
}

// Ids that one part holds, each with the part that named it first.
using PartOfId = std::map<int, std::string>;

void ClaimMarkers(const Item& item, const std::string& part, const std::vector<int>& ids,
                  PartOfId* part_of_id) {
  for (const int id : ids) {
    const std::string& owner = part_of_id->emplace(id, part).first->second;
    if (owner != part) {
      item.Fail(
          fmt::format("marker {} is in part '{}' already; a marker is in one part", id, owner));
    }
  }
}

std::vector<MarkerLine> ReadLines(const Item& list, const std::string& part, PartOfId* part_of_id) {
  std::vector<MarkerLine> lines;
  std::set<std::string> names;
  ForEachElement(list, [&](const Item& item) {
    MarkerLine line;
    ReadMap(item, {{"name", [&](const Item& value) { line.name = ReadString(value); }},
                   {"markers", [&](const Item& value) {
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

LayoutPart ReadPart(const Item& item, const std::string& name, PartOfId* part_of_id) {
  LayoutPart part;
  part.name = name;
  ReadMap(item, {{"rigid", [&](const Item& value) { part.rigid = ReadBool(value); }},
                 {"horizontal",
                  [&](const Item& value) { part.horizontal = ReadLines(value, name, part_of_id); }},
                 {"vertical",
                  [&](const Item& value) { part.vertical = ReadLines(value, name, part_of_id); }},
                 {"markers", [&](const Item& value) {
                    part.marker_ids = ReadMarkerIds(value);
                    ClaimMarkers(value, name, part.marker_ids, part_of_id);
                  }}});
  if (part.horizontal.empty() && part.vertical.empty() && part.marker_ids.empty()) {
    item.Fail("the part has no markers");
  }
  return part;
}

std::vector<LayoutPart> ReadParts(const Item& item) {
  std::vector<LayoutPart> parts;
  PartOfId part_of_id;
  ForEachKey(item, [&](const std::string& name, const Item& value) {
    parts.push_back(ReadPart(value, name, &part_of_id));
  });
  if (parts.empty()) item.Fail("no part is named; leave the key out to accept every marker");
  return parts;
}

std::map<int, double> ReadMarkerLengths(const Item& item) {
  std::map<int, double> lengths_m;
  ForEachKey(item, [&](const std::string& name, const Item& value) {
    int id = -1;
    if (!ParseNumber(name, &id) || id < 0 || id > kMaxMarkerId) {
      value.Fail(fmt::format("'{}' is no marker id; {{id: length in m}} is expected", name));
    }
    lengths_m[id] = ReadLength(value);
  });
  return lengths_m;
}

int ReadBorderBits(const Item& item) {
  int border_bits = 0;
  if (!item.node.IsScalar() || !ParseNumber(item.node.Scalar(), &border_bits) || border_bits < 1 ||
      border_bits > 8) {
    item.Fail("the width of the black border in cells is expected, 1 to 8");
  }
  return border_bits;
}

std::string ReadDictionaryName(const Item& item) {
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
    Fail(path, exception.mark, "no valid YAML: " + exception.msg);
  }
  const Item top{path, root, ""};
  Layout layout;
  std::optional<Item> reference;
  ReadMap(top, {{"dictionary", [&](const Item& v) { layout.dictionary = ReadDictionaryName(v); }},
                {"marker_length", [&](const Item& v) { layout.marker_length_m = ReadLength(v); }},
                {"marker_lengths",
                 [&](const Item& v) { layout.marker_lengths_m = ReadMarkerLengths(v); }},
                {"border_bits", [&](const Item& v) { layout.border_bits = ReadBorderBits(v); }},
                {"parts", [&](const Item& v) { layout.parts = ReadParts(v); }},
                {"reference_part", [&](const Item& v) { reference.emplace(v); }}});
  if (layout.dictionary.empty()) top.Fail("key 'dictionary' is missing, such as DICT_4X4_50");
  if (layout.marker_length_m == 0.0) top.Fail("key 'marker_length' is missing (metres)");
  if (reference) {
    layout.reference_part = ReadString(*reference);
    bool known = false;
    for (const LayoutPart& part : layout.parts) known |= part.name == *layout.reference_part;
    if (!known) reference->Fail("there is no part '" + *layout.reference_part + "'");
  }
  return layout;
}

}  // namespace velamap
