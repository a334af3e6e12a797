// A strict PLY reader that is independent of the writer and accounts for every byte.

#pragma once

#include <string>
#include <vector>

namespace velamap {

struct PlyReadProperty {
  std::string type;
  std::string list_count_type;  // empty: a scalar
  std::string name;
};

struct PlyReadElement {
  std::string name;
  std::vector<PlyReadProperty> properties;
  std::vector<std::vector<std::vector<double>>> rows;  // [row][property][entry of a list, or 0]

  // Values of a scalar property; throws std::runtime_error if it does not exist.
  std::vector<double> Column(const std::string& property) const;
  std::vector<std::vector<double>> ListColumn(const std::string& property) const;
};

struct PlyFile {
  std::string format;
  std::vector<PlyReadElement> elements;
};

// Throws std::runtime_error for anything but a complete PLY file.
PlyFile ReadPly(const std::string& bytes);

}  // namespace velamap
