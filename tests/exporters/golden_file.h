// Small expected files in tests/exporters/golden.

#pragma once

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace velamap {

inline std::string ReadBytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot open " + path);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

inline std::string Golden(const std::string& name) {
  return ReadBytes(std::string(VELAMAP_GOLDEN_DIR) + "/" + name);
}

}  // namespace velamap
