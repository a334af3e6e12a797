#include "exporters/formats/ply_writer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <ostream>
#include <string>

#include <fmt/format.h>

#include "importer/base/csv.h"

namespace velamap {
namespace {

// One description of an element drives its header, its ASCII body and its binary body, so that they
// cannot disagree. A double holds every value of the four types exactly.
enum class PlyType { kUchar, kInt, kFloat, kDouble };

template <typename Row>
struct PlyProperty {
  const char* name;
  PlyType type;
  std::function<double(const Row&, int)> value;  // of entry i of a list; i is 0 for a scalar
  int list_size = 0;                             // 0: a scalar
};

template <typename Row>
struct PlyElement {
  const char* name;
  std::vector<PlyProperty<Row>> properties;
  std::vector<Row> rows;
};

const char* TypeName(PlyType type) {
  switch (type) {
    case PlyType::kUchar:
      return "uchar";
    case PlyType::kInt:
      return "int";
    case PlyType::kFloat:
      return "float";
    case PlyType::kDouble:
      return "double";
  }
  throw std::logic_error("unknown PLY type");
}

// Least significant byte first on every machine.
template <typename Bits, typename T>
void AppendLittleEndian(T value, std::string* body) {
  static_assert(sizeof(Bits) == sizeof(T));
  Bits bits;
  std::memcpy(&bits, &value, sizeof bits);
  for (std::size_t i = 0; i < sizeof bits; ++i) body->push_back(static_cast<char>(bits >> (8 * i)));
}

void AppendBinary(PlyType type, double value, std::string* body) {
  switch (type) {
    case PlyType::kUchar:
      return body->push_back(static_cast<char>(static_cast<std::uint8_t>(value)));
    case PlyType::kInt:
      return AppendLittleEndian<std::uint32_t>(static_cast<std::int32_t>(value), body);
    case PlyType::kFloat:
      return AppendLittleEndian<std::uint32_t>(static_cast<float>(value), body);
    case PlyType::kDouble:
      return AppendLittleEndian<std::uint64_t>(value, body);
  }
}

// Shortest digits that read back to the same number, in any locale.
void AppendAscii(PlyType type, double value, std::string* body) {
  if (!body->empty() && body->back() != '\n') body->push_back(' ');
  if (type == PlyType::kDouble) {
    fmt::format_to(std::back_inserter(*body), "{}", value);
  } else if (type == PlyType::kFloat) {
    fmt::format_to(std::back_inserter(*body), "{}", static_cast<float>(value));
  } else {
    fmt::format_to(std::back_inserter(*body), "{}", static_cast<std::int32_t>(value));
  }
}

template <typename Row>
std::string ElementHeader(const PlyElement<Row>& element) {
  std::string header = fmt::format("element {} {}\n", element.name, element.rows.size());
  for (const PlyProperty<Row>& property : element.properties) {
    header += fmt::format("property {}{} {}\n", property.list_size > 0 ? "list uchar " : "",
                          TypeName(property.type), property.name);
  }
  return header;
}

template <typename Row>
std::string ElementBody(const PlyElement<Row>& element, PlyFormat format) {
  const bool is_ascii = format == PlyFormat::kAscii;
  const auto append = is_ascii ? AppendAscii : AppendBinary;
  std::string body;
  for (const Row& row : element.rows) {
    for (const PlyProperty<Row>& property : element.properties) {
      if (property.list_size > 0) append(PlyType::kUchar, property.list_size, &body);
      for (int i = 0; i < std::max(property.list_size, 1); ++i) {
        append(property.type, property.value(row, i), &body);
      }
    }
    if (is_ascii) body += '\n';
  }
  return body;
}

struct PlyComments {
  std::string content;
  std::string frame;  // empty: no such comment
};

template <typename... Rows>
void WritePly(PlyFormat format, const PlyComments& comments, std::ostream& out,
              const PlyElement<Rows>&... elements) {
  out << "ply\nformat " << (format == PlyFormat::kAscii ? "ascii" : "binary_little_endian")
      << " 1.0\ncomment " << comments.content << '\n';
  if (!comments.frame.empty()) out << "comment frame " << SingleLine(comments.frame) << '\n';
  (out << ... << ElementHeader(elements)) << "end_header\n";
  (out << ... << ElementBody(elements, format));
}

struct Vertex {
  Eigen::Vector3d x_in_shape_m;
  Eigen::Vector3d normal;  // zero where there is none
  Rgb color{};
  int marker_id = 0;
  int corner = 0;
  std::optional<double> sigma_m;
};

struct Face {
  std::array<int, kNumCorners> vertex_indices;
  int marker_id = 0;
};

std::vector<PlyProperty<Vertex>> PositionAndNormal() {
  return {
      {"x", PlyType::kDouble, [](const Vertex& v, int) { return v.x_in_shape_m.x(); }},
      {"y", PlyType::kDouble, [](const Vertex& v, int) { return v.x_in_shape_m.y(); }},
      {"z", PlyType::kDouble, [](const Vertex& v, int) { return v.x_in_shape_m.z(); }},
      {"nx", PlyType::kFloat, [](const Vertex& v, int) { return v.normal.x(); }},
      {"ny", PlyType::kFloat, [](const Vertex& v, int) { return v.normal.y(); }},
      {"nz", PlyType::kFloat, [](const Vertex& v, int) { return v.normal.z(); }},
  };
}

void AddColor(std::vector<PlyProperty<Vertex>>* properties) {
  properties->push_back({"red", PlyType::kUchar, [](const Vertex& v, int) { return v.color[0]; }});
  properties->push_back(
      {"green", PlyType::kUchar, [](const Vertex& v, int) { return v.color[1]; }});
  properties->push_back({"blue", PlyType::kUchar, [](const Vertex& v, int) { return v.color[2]; }});
}

void AddIdentity(std::vector<PlyProperty<Vertex>>* properties) {
  properties->push_back(
      {"marker_id", PlyType::kInt, [](const Vertex& v, int) { return v.marker_id; }});
  properties->push_back({"corner", PlyType::kInt, [](const Vertex& v, int) { return v.corner; }});
}

// Once all rows are there: all of them have the property or none, for PLY knows no empty value.
void AddSigma(PlyElement<Vertex>* vertices) {
  const auto has_sigma = [](const Vertex& v) { return v.sigma_m.has_value(); };
  if (vertices->rows.empty() ||
      !std::all_of(vertices->rows.begin(), vertices->rows.end(), has_sigma)) {
    return;
  }
  vertices->properties.push_back(
      {"sigma", PlyType::kFloat, [](const Vertex& v, int) { return *v.sigma_m; }});
}

Vertex MakeVertex(const ShapeMarker& marker, int corner) {
  Vertex vertex;
  vertex.x_in_shape_m = *marker.x_in_shape_m[corner];
  vertex.normal.setZero();
  if (marker.IsWhole()) vertex.normal += MarkerNormal(marker);  // added, so that no -0 is written
  vertex.marker_id = marker.marker_id;
  vertex.corner = corner;
  if (marker.sigma_m[corner]) vertex.sigma_m = marker.sigma_m[corner]->norm() / std::sqrt(3.0);
  return vertex;
}

Rgb CornerColor(const Model& model, int marker_id, int corner) {
  const auto point = model.points3D.find(Point3DIdFromCorner({marker_id, corner}));
  VELAMAP_CHECK(point != model.points3D.end());  // the shape is this model's
  return point->second.color;
}

Rgb VertexColor(const Model& model, const Vertex& vertex) {
  if (vertex.corner > 0) return CornerColor(model, vertex.marker_id, vertex.corner);
  std::array<int, 3> sums{};
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    const Rgb color = CornerColor(model, vertex.marker_id, corner);
    for (int i = 0; i < 3; ++i) sums[i] += color[i];
  }
  Rgb mean;
  for (int i = 0; i < 3; ++i) {
    mean[i] = static_cast<std::uint8_t>((sums[i] + kNumCorners / 2) / kNumCorners);
  }
  return mean;
}

// Colours that are told apart by most eyes (Okabe and Ito, "Color universal design", 2008), one a
// part in the order of their names.
std::map<std::string, Rgb> PartColors(const MarkerShape& shape) {
  constexpr std::array<Rgb, 7> kPalette = {{{0, 114, 178},
                                            {230, 159, 0},
                                            {0, 158, 115},
                                            {213, 94, 0},
                                            {86, 180, 233},
                                            {204, 121, 167},
                                            {240, 228, 66}}};
  std::map<std::string, Rgb> colors;
  for (const ShapeMarker& marker : shape.markers) colors[marker.part] = {};
  std::size_t idx = 0;
  for (auto& [part, color] : colors) color = kPalette[idx++ % kPalette.size()];
  return colors;
}

}  // namespace

void WritePointsPly(const MarkerShape& shape, const Model& metric_model, PlyFormat format,
                    std::ostream& out, const std::string& frame) {
  PlyElement<Vertex> vertices{"vertex", PositionAndNormal(), {}};
  AddColor(&vertices.properties);
  AddIdentity(&vertices.properties);
  for (const ShapeMarker& marker : shape.markers) {
    for (int corner = 0; corner <= kNumCorners; ++corner) {
      if (!marker.x_in_shape_m[corner]) continue;
      vertices.rows.push_back(MakeVertex(marker, corner));
      vertices.rows.back().color = VertexColor(metric_model, vertices.rows.back());
    }
  }
  AddSigma(&vertices);
  WritePly(format, {"velamap marker centres (corner 0) and corners (1 to 4), metres", frame}, out,
           vertices);
}

void WriteMarkersPly(const MarkerShape& shape, PlyFormat format, std::ostream& out,
                     const std::string& frame) {
  const std::map<std::string, Rgb> part_colors = PartColors(shape);
  PlyElement<Vertex> vertices{"vertex", PositionAndNormal(), {}};
  AddColor(&vertices.properties);
  AddIdentity(&vertices.properties);
  PlyElement<Face> faces{
      "face",
      {{"vertex_indices", PlyType::kInt,
        [](const Face& face, int i) { return face.vertex_indices[i]; }, kNumCorners},
       {"marker_id", PlyType::kInt, [](const Face& face, int) { return face.marker_id; }}},
      {}};
  for (const ShapeMarker& marker : shape.markers) {
    if (!marker.IsWhole()) continue;
    const int first = static_cast<int>(vertices.rows.size());
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      vertices.rows.push_back(MakeVertex(marker, corner));
      vertices.rows.back().color = part_colors.at(marker.part);
    }
    // Corners 1..4 run clockwise seen from the front; a face runs the other way.
    faces.rows.push_back({{first, first + 3, first + 2, first + 1}, marker.marker_id});
  }
  AddSigma(&vertices);
  WritePly(format, {"velamap markers, metres", frame}, out, vertices, faces);
}

}  // namespace velamap
