#include "importer/layout/yaml_item.h"

#include <algorithm>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/base/error.h"
#include "importer/text/nearest_name.h"

namespace velamap {
namespace {

// The first line up to `last_line` that begins with a tab, counted from 0; -1 if none does.
int LineIndentedByTab(const std::string& text, int last_line) {
  std::istringstream lines(text);
  std::string line;
  for (int i = 0; i <= last_line && std::getline(lines, line); ++i) {
    const std::size_t content = line.find_first_not_of(" \t");
    const std::size_t tab = line.find('\t');
    if (content != std::string::npos && line[content] != '#' && tab < content) return i;
  }
  return -1;
}

[[noreturn]] void FailYaml(const std::string& path, const YAML::Mark& mark,
                           const std::string& message) {
  if (mark.is_null()) throw InputError(fmt::format("{}: {}", path, message));
  throw InputError(fmt::format("{}:{}: {}", path, mark.line + 1, message));
}

}  // namespace

YAML::Node LoadYaml(const std::string& path, const std::string& text) {
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& exception) {
    // If a tab is to blame, the parser may give up one line later.
    const int tab_line = LineIndentedByTab(text, exception.mark.line + 1);
    if (tab_line >= 0) {
      throw InputError(fmt::format(
          "{}:{}: no valid YAML: the line is indented by a tab; use spaces", path, tab_line + 1));
    }
    const bool is_bracket = exception.msg.find("flow") != std::string::npos;
    FailYaml(path, exception.mark,
             fmt::format("no valid YAML ({}): {}", exception.msg,
                         is_bracket ? "here or above, a list that begins with [ has to end with ], "
                                      "and a map that begins with { with }"
                                    : "write 'key: value' with a space after the colon, and indent "
                                      "the keys of one level by the same number of spaces"));
  }
}

void YamlItem::Fail(const std::string& message) const {
  FailYaml(path, node.Mark(), key.empty() ? message : key + ": " + message);
}

void ForEachKey(const YamlItem& map,
                const std::function<void(const std::string&, const YamlItem&)>& handle) {
  if (!map.node.IsMap()) map.Fail("a map of 'key: value' is expected");
  std::set<std::string> seen;
  for (const auto& entry : map.node) {
    if (!entry.first.IsScalar()) FailYaml(map.path, entry.first.Mark(), "a plain key is expected");
    const std::string name = entry.first.Scalar();
    const std::string key = map.key.empty() ? name : map.key + "." + name;
    if (!seen.insert(name).second) FailYaml(map.path, entry.first.Mark(), key + ": is given twice");
    // An empty value has no mark in yaml-cpp, so the error names the line of the key.
    if (entry.second.IsNull()) FailYaml(map.path, entry.first.Mark(), key + ": has no value");
    handle(name, YamlItem{map.path, entry.second, key});
  }
}

void ReadMap(const YamlItem& map, const KeyHandlers& handlers) {
  ForEachKey(map, [&](const std::string& name, const YamlItem& value) {
    const auto handler = handlers.find(name);
    if (handler == handlers.end()) {
      std::vector<std::string> known;
      for (const auto& [known_name, function] : handlers) known.push_back(known_name);
      value.Fail(fmt::format("unknown key; {}known here: {}", DidYouMean(name, known),
                             fmt::join(known, " ")));
    }
    handler->second(value);
  });
}

void ReadMap(const YamlItem& map, const KeyHandlers& handlers,
             const std::vector<std::string>& required, const std::string& example) {
  ReadMap(map, handlers);
  for (const std::string& key : required) {
    if (map.node[key]) continue;
    map.Fail(fmt::format("key '{}' is missing; expected an entry like {}", key, example));
  }
}

void ForEachElement(const YamlItem& list, const std::function<void(const YamlItem&)>& handle) {
  if (!list.node.IsSequence()) list.Fail("a list is expected, such as [1, 2, 3]");
  for (std::size_t i = 0; i < list.node.size(); ++i) {
    handle(YamlItem{list.path, list.node[i], fmt::format("{}[{}]", list.key, i)});
  }
}

std::string CheckedName(const std::string& name, const YamlItem& item) {
  if (name.empty()) item.Fail("a name is expected");
  const bool is_printable = std::none_of(name.begin(), name.end(),
                                         [](unsigned char c) { return c < ' ' || c == '\x7f'; });
  if (!is_printable) {
    item.Fail("a name without line breaks and other control characters is expected");
  }
  return name;
}

std::string ReadString(const YamlItem& item) { return CheckedName(item.Text(), item); }

bool ReadBool(const YamlItem& item) {
  bool value = false;
  if (!item.node.IsScalar() || !YAML::convert<bool>::decode(item.node, value)) {
    item.Fail("true or false is expected");
  }
  return value;
}

}  // namespace velamap
