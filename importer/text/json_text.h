// JSON as text that every reader accepts, whatever the names in it are.

#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace velamap {

// Indents by `indent` spaces a level; -1: one line. File names need not be UTF-8, so bytes that are
// not are replaced.
inline std::string JsonText(const nlohmann::ordered_json& json, int indent = -1) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace velamap
