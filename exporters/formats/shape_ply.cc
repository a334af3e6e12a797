#include "exporters/formats/shape_ply.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace velamap {
namespace {

struct Vertex {
  Eigen::Vector3d x_in_shape_m;
  Eigen::Vector3d normal;  // zero for a marker that is not whole
  Rgb color{};
  int marker_id = 0;
  int corner = 0;
  std::optional<double> sigma_m;
};

struct Face {
  std::array<int, kNumCorners> vertex_indices;
  int marker_id = 0;
};

PlyElement<Vertex> VertexElement() {
  PlyElement<Vertex> vertices{"vertex", {}, {}};
  vertices.AddVector({"x", "y", "z"}, PlyType::kDouble,
                     [](const Vertex& v) { return v.x_in_shape_m; });
  vertices.AddVector({"nx", "ny", "nz"}, PlyType::kFloat, [](const Vertex& v) { return v.normal; });
  vertices.AddVector({"red", "green", "blue"}, PlyType::kUchar,
                     [](const Vertex& v) { return v.color; });
  vertices.Add("marker_id", PlyType::kInt, [](const Vertex& v) { return v.marker_id; });
  vertices.Add("corner", PlyType::kInt, [](const Vertex& v) { return v.corner; });
  return vertices;
}

// Called when all rows are there. PLY has no empty value, so all vertices have the property or
// none.
void AddSigma(PlyElement<Vertex>* vertices) {
  const auto has_sigma = [](const Vertex& v) { return v.sigma_m.has_value(); };
  if (vertices->rows.empty() ||
      !std::all_of(vertices->rows.begin(), vertices->rows.end(), has_sigma)) {
    return;
  }
  vertices->Add("sigma", PlyType::kFloat, [](const Vertex& v) { return *v.sigma_m; });
}

std::vector<std::string> Comments(const std::string& content, const std::string& frame) {
  if (frame.empty()) return {content};
  return {content, "frame " + frame};
}

Vertex MakeVertex(const ShapeMarker& marker, int corner) {
  Vertex vertex;
  vertex.x_in_shape_m = *marker.x_in_shape_m[corner];
  vertex.normal.setZero();
  if (marker.IsWhole()) vertex.normal += MarkerNormal(marker);  // added, so that no -0 is written
  vertex.marker_id = marker.marker_id;
  vertex.corner = corner;
  if (marker.sigma_m[corner]) vertex.sigma_m = SigmaOfCoordinate(*marker.sigma_m[corner]);
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

// One colour per part in the order of their names, from a palette for all kinds of colour vision
// (Okabe and Ito, "Color universal design", 2008).
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
  PlyElement<Vertex> vertices = VertexElement();
  for (const ShapeMarker& marker : shape.markers) {
    for (int corner = 0; corner <= kNumCorners; ++corner) {
      if (!marker.x_in_shape_m[corner]) continue;
      vertices.rows.push_back(MakeVertex(marker, corner));
      vertices.rows.back().color = VertexColor(metric_model, vertices.rows.back());
    }
  }
  AddSigma(&vertices);
  WritePly(format,
           Comments("velamap marker centres (corner 0) and corners (1 to 4), metres", frame), out,
           vertices);
}

void WriteMarkersPly(const MarkerShape& shape, PlyFormat format, std::ostream& out,
                     const std::string& frame) {
  const std::map<std::string, Rgb> part_colors = PartColors(shape);
  PlyElement<Vertex> vertices = VertexElement();
  PlyElement<Face> faces{"face", {}, {}};
  faces.AddList("vertex_indices", PlyType::kInt, kNumCorners,
                [](const Face& face, int i) { return face.vertex_indices[i]; });
  faces.Add("marker_id", PlyType::kInt, [](const Face& face) { return face.marker_id; });
  for (const ShapeMarker& marker : shape.markers) {
    if (!marker.IsWhole()) continue;
    const int first = static_cast<int>(vertices.rows.size());
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      vertices.rows.push_back(MakeVertex(marker, corner));
      vertices.rows.back().color = part_colors.at(marker.part);
    }
    faces.rows.push_back({MarkerFace(first), marker.marker_id});
  }
  AddSigma(&vertices);
  WritePly(format, Comments("velamap markers, metres", frame), out, vertices, faces);
}

}  // namespace velamap
