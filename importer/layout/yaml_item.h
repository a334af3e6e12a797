// Strict reading of YAML. All functions throw InputError that names file, line and key.

#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace velamap {

// Parses `text`, the content of the file. The error says what is usually wrong where the parser
// gives up: a tab, an open bracket, or the indentation.
YAML::Node LoadYaml(const std::string& path, const std::string& text);

// A node with the path of its file and its full key, for error messages.
struct YamlItem {
  const std::string& path;
  YAML::Node node;
  std::string key;

  [[noreturn]] void Fail(const std::string& message) const;
  // The text of a scalar, or an empty string for other nodes.
  std::string Text() const { return node.IsScalar() ? node.Scalar() : ""; }
};

// Calls handle(name, value) for every key of a map. A key that is repeated or has no value is an
// error.
void ForEachKey(const YamlItem& map,
                const std::function<void(const std::string&, const YamlItem&)>& handle);

using KeyHandlers = std::map<std::string, std::function<void(const YamlItem&)>>;

// Calls the handler of every key in the map. A key without a handler is an error, whose message
// names the nearest known key and lists all of them.
void ReadMap(const YamlItem& map, const KeyHandlers& handlers);

// The same for a map that must have the keys `required`. The error message for a missing key shows
// `example`.
void ReadMap(const YamlItem& map, const KeyHandlers& handlers,
             const std::vector<std::string>& required, const std::string& example);

void ForEachElement(const YamlItem& list, const std::function<void(const YamlItem&)>& handle);

// Returns `name`. Throws InputError if it is empty or has control characters, which would break the
// lines of tables and files.
std::string CheckedName(const std::string& name, const YamlItem& item);
std::string ReadString(const YamlItem& item);
bool ReadBool(const YamlItem& item);

}  // namespace velamap
