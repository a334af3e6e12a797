// Strict reading of YAML: every error names file, line and key.

#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace velamap {

[[noreturn]] void FailYaml(const std::string& path, const YAML::Mark& mark,
                           const std::string& message);

// A node with its file and its full key, which errors name.
struct YamlItem {
  const std::string& path;
  YAML::Node node;
  std::string key;

  // Throws InputError.
  [[noreturn]] void Fail(const std::string& message) const;
  // The text of a scalar; empty for anything else.
  std::string Text() const { return node.IsScalar() ? node.Scalar() : ""; }
};

// Calls handle(name, value) for every key of a map. A repeated key is an error.
void ForEachKey(const YamlItem& map,
                const std::function<void(const std::string&, const YamlItem&)>& handle);

using KeyHandlers = std::map<std::string, std::function<void(const YamlItem&)>>;

// Calls the handler of every key in the map. A key without a handler is an error that lists the
// known keys.
void ReadMap(const YamlItem& map, const KeyHandlers& handlers);

// The same for a map that has to have the keys `required`; the error for one that is missing shows
// an example of such a map.
void ReadMap(const YamlItem& map, const KeyHandlers& handlers,
             const std::vector<std::string>& required, const std::string& example);

void ForEachElement(const YamlItem& list, const std::function<void(const YamlItem&)>& handle);

// Returns a name that is fit for files and tables. Throws InputError for one that is not.
std::string CheckedName(const std::string& name, const YamlItem& item);
std::string ReadString(const YamlItem& item);
bool ReadBool(const YamlItem& item);

}  // namespace velamap
