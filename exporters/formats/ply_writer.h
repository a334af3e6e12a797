// Writes PLY files. One description of an element gives its header, its ASCII body and its binary
// body:
//
//   PlyElement<Eigen::Vector3d> vertices{"vertex", points_m, {}};
//   vertices.AddVector({"x", "y", "z"}, PlyType::kDouble, [](const auto& x_m) { return x_m; });
//   WritePly(PlyFormat::kAscii, {"points, metres"}, out, vertices);

#pragma once

#include <algorithm>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace velamap {

enum class PlyFormat { kBinaryLittleEndian, kAscii };

enum class PlyType { kUchar, kInt, kFloat, kDouble };

template <typename Row>
struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kDouble;
  std::function<double(const Row&, int)> value;  // entry i of a list; i is 0 for a scalar
  int list_size = 0;                             // 0 for a scalar
};

template <typename Row>
struct PlyElement {
  std::string name;
  std::vector<Row> rows;
  std::vector<PlyProperty<Row>> properties;

  // A double represents every value of the four types exactly.
  void Add(const std::string& property, PlyType type, std::function<double(const Row&)> value) {
    properties.push_back(
        {property, type, [value = std::move(value)](const Row& row, int) { return value(row); }});
  }
  // One property for each component of a vector.
  template <typename Function>
  void AddVector(const std::vector<std::string>& names, PlyType type, const Function& vector) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      Add(names[i], type, [vector, i](const Row& row) -> double { return vector(row)[i]; });
    }
  }
  // All rows have lists of the same size.
  void AddList(const std::string& property, PlyType type, int list_size,
               std::function<double(const Row&, int)> value) {
    properties.push_back({property, type, std::move(value), list_size});
  }
};

namespace internal {

void WritePlyHead(PlyFormat format, const std::vector<std::string>& comments, std::ostream& out);
std::string PlyPropertyLine(const std::string& name, PlyType type, bool is_list);
// ASCII numbers have the fewest digits that read back to the same value.
void AppendPlyValue(PlyFormat format, PlyType type, double value, std::string* body);

template <typename Row>
void WritePlyElementHeader(const PlyElement<Row>& element, std::ostream& out) {
  out << "element " << element.name << ' ' << std::to_string(element.rows.size()) << '\n';
  for (const PlyProperty<Row>& property : element.properties) {
    out << PlyPropertyLine(property.name, property.type, property.list_size > 0);
  }
}

template <typename Row>
void WritePlyElementBody(PlyFormat format, const PlyElement<Row>& element, std::ostream& out) {
  constexpr std::size_t kChunkSize = 1 << 16;
  std::string body;
  for (const Row& row : element.rows) {
    for (const PlyProperty<Row>& property : element.properties) {
      if (property.list_size > 0) {
        AppendPlyValue(format, PlyType::kUchar, property.list_size, &body);
      }
      for (int i = 0; i < std::max(property.list_size, 1); ++i) {
        AppendPlyValue(format, property.type, property.value(row, i), &body);
      }
    }
    if (format == PlyFormat::kAscii) body += '\n';
    if (body.size() < kChunkSize) continue;
    out << body;
    body.clear();
  }
  out << body;
}

}  // namespace internal

// Line breaks in comments become spaces.
template <typename... Rows>
void WritePly(PlyFormat format, const std::vector<std::string>& comments, std::ostream& out,
              const PlyElement<Rows>&... elements) {
  internal::WritePlyHead(format, comments, out);
  (internal::WritePlyElementHeader(elements, out), ...);
  out << "end_header\n";
  (internal::WritePlyElementBody(format, elements, out), ...);
}

}  // namespace velamap
