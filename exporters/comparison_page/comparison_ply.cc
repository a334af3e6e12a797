#include "exporters/comparison_page/comparison_ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "exporters/formats/ply_writer.h"
#include "exporters/formats/shape_ply.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

struct Vertex {
  Eigen::Vector3d x_in_reference_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Array3d color = Eigen::Array3d::Zero();
  double distance_m = 0.0;
  double sigma_m = 0.0;
  int marker_id = 0;
  int corner = 0;
};

template <std::size_t kSize>
struct Face {
  std::array<int, kSize> vertex_indices;
  int marker_id = 0;
};

std::vector<std::string> Comments(const std::string& content, double limit_m) {
  return {content, "distance: positive on the side of the reference's normal",
          fmt::format("colours: blue -{0:g} mm, white 0, red +{0:g} mm, grey beside the reference",
                      kMmPerM * limit_m)};
}

void AddPosition(PlyElement<Vertex>* vertices) {
  vertices->AddVector({"x", "y", "z"}, PlyType::kDouble,
                      [](const Vertex& v) { return v.x_in_reference_m; });
}

void AddColorAndDistance(PlyElement<Vertex>* vertices) {
  vertices->AddVector({"red", "green", "blue"}, PlyType::kUchar,
                      [](const Vertex& v) { return v.color; });
  vertices->Add("distance", PlyType::kFloat, [](const Vertex& v) { return v.distance_m; });
}

template <std::size_t kSize>
PlyElement<Face<kSize>> FaceElement() {
  PlyElement<Face<kSize>> faces{"face", {}, {}};
  faces.AddList("vertex_indices", PlyType::kInt, static_cast<int>(kSize),
                [](const Face<kSize>& face, int i) {
                  return face.vertex_indices[static_cast<std::size_t>(i)];
                });
  return faces;
}

}  // namespace

Eigen::Array3d DivergingColor(const std::optional<double>& distance_m, double limit_m) {
  const Eigen::Array3d blue(33, 102, 172), white(247, 247, 247), red(178, 24, 43);
  if (!distance_m) return Eigen::Array3d::Constant(128);
  const double part = limit_m > 0 ? std::clamp(*distance_m / limit_m, -1.0, 1.0) : 0.0;
  const Eigen::Array3d& end = part < 0 ? blue : red;
  const Eigen::Array3d color = white + std::abs(part) * (end - white);
  return color.round();
}

void WriteComparisonPly(const ShapeDeviation& deviation, std::optional<double> color_limit_m,
                        std::ostream& out) {
  const double limit_m = color_limit_m.value_or(deviation.distance_m.MaxAbs());
  PlyElement<Vertex> vertices{"vertex", {}, {}};
  AddPosition(&vertices);
  vertices.AddVector({"nx", "ny", "nz"}, PlyType::kFloat, [](const Vertex& v) { return v.normal; });
  AddColorAndDistance(&vertices);
  if (std::all_of(deviation.markers.begin(), deviation.markers.end(),
                  [](const auto& marker) { return marker.sigma_m.has_value(); })) {
    vertices.Add("sigma", PlyType::kFloat, [](const Vertex& v) { return v.sigma_m; });
  }
  vertices.Add("marker_id", PlyType::kInt, [](const Vertex& v) { return v.marker_id; });
  vertices.Add("corner", PlyType::kInt, [](const Vertex& v) { return v.corner; });
  auto faces = FaceElement<kNumCorners>();
  faces.Add("marker_id", PlyType::kInt, [](const auto& face) { return face.marker_id; });
  for (const MarkerDeviation& compared : deviation.markers) {
    const ShapeMarker* marker = FindWholeMarker(deviation.aligned_shape, compared.marker_id);
    VELAMAP_CHECK(marker != nullptr);
    Vertex vertex;
    vertex.normal = MarkerNormal(*marker);
    vertex.color = DivergingColor(
        compared.is_over_surface ? std::optional(compared.distance_m) : std::nullopt, limit_m);
    vertex.distance_m = compared.is_over_surface ? compared.distance_m : kUnknown;
    vertex.sigma_m = compared.is_over_surface ? compared.sigma_m.value_or(0.0) : kUnknown;
    vertex.marker_id = compared.marker_id;
    faces.rows.push_back({MarkerFace(static_cast<int>(vertices.rows.size())), compared.marker_id});
    for (vertex.corner = 1; vertex.corner <= kNumCorners; ++vertex.corner) {
      vertex.x_in_reference_m = *marker->x_in_shape_m[static_cast<std::size_t>(vertex.corner)];
      vertices.rows.push_back(vertex);
    }
  }
  const std::string content =
      fmt::format("velamap comparison, metres, frame of the reference, alignment: {}",
                  AlignmentMethodName(deviation.alignment.method));
  WritePly(PlyFormat::kAscii, Comments(content, limit_m), out, vertices, faces);
}

void WriteComparisonSurfacePly(const SurfaceComparison& comparison,
                               std::optional<double> color_limit_m, std::ostream& out) {
  const double limit_m = color_limit_m.value_or(LargestDistance(comparison));
  PlyElement<Vertex> vertices{"vertex", {}, {}};
  AddPosition(&vertices);
  AddColorAndDistance(&vertices);
  auto faces = FaceElement<3>();
  for (const SurfaceDeviation& part : comparison.parts) {
    const int first = static_cast<int>(vertices.rows.size());
    for (std::size_t i = 0; i < part.mesh.vertices_m.size(); ++i) {
      Vertex vertex;
      vertex.x_in_reference_m = part.mesh.vertices_m[i];
      vertex.color = DivergingColor(part.distance_m[i], limit_m);
      vertex.distance_m = part.distance_m[i].value_or(kUnknown);
      vertices.rows.push_back(vertex);
    }
    for (const auto& [a, b, c] : part.mesh.triangles) {
      faces.rows.push_back({{first + a, first + b, first + c}});
    }
  }
  WritePly(PlyFormat::kAscii,
           Comments("velamap comparison of surfaces, metres, frame of the reference", limit_m), out,
           vertices, faces);
}

}  // namespace velamap
