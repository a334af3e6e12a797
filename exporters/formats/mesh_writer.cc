#include "exporters/formats/mesh_writer.h"

#include <cstdint>
#include <numeric>
#include <ostream>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "exporters/formats/little_endian.h"
#include "exporters/formats/ply_writer.h"
#include "importer/text/csv.h"

namespace velamap {
namespace {

// PLY rows: indices into the mesh.
std::vector<int> Indices(std::size_t size) {
  std::vector<int> indices(size);
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

void AppendFloats(const Eigen::Vector3d& values, std::string* bytes) {
  for (const double value : values) AppendLittleEndian(static_cast<float>(value), bytes);
}

std::string HeaderStart(LengthUnit unit) {
  return fmt::format("velamap, unit {}, surface of ", ChoiceName(kLengthUnits, unit));
}

}  // namespace

void WriteMeshPly(const TriangleMesh& mesh, const std::string& name, PlyFormat format,
                  std::ostream& out) {
  PlyElement<int> vertices{"vertex", Indices(mesh.vertices_m.size()), {}};
  const auto add = [&vertices](const auto& values, PlyType type,
                               const std::vector<std::string>& names) {
    if (values.empty()) return;
    vertices.AddVector(names, type,
                       [&values](int i) { return values[static_cast<std::size_t>(i)]; });
  };
  add(mesh.vertices_m, PlyType::kDouble, {"x", "y", "z"});
  add(mesh.normals, PlyType::kFloat, {"nx", "ny", "nz"});
  add(mesh.surface_parameters, PlyType::kFloat, {"s", "t"});
  if (!mesh.sigmas_m.empty()) {
    vertices.Add("sigma", PlyType::kFloat,
                 [&mesh](int i) { return mesh.sigmas_m[static_cast<std::size_t>(i)]; });
  }
  PlyElement<int> faces{"face", Indices(mesh.triangles.size()), {}};
  faces.AddList("vertex_indices", PlyType::kInt, 3, [&mesh](int face, int i) {
    return mesh.triangles[static_cast<std::size_t>(face)][static_cast<std::size_t>(i)];
  });
  WritePly(format, {"velamap surface of " + name + ", unit m"}, out, vertices, faces);
}

void WriteMeshObj(const TriangleMesh& mesh, const std::string& name, LengthUnit unit,
                  std::ostream& out) {
  const bool has_normals = !mesh.normals.empty();
  const bool has_parameters = !mesh.surface_parameters.empty();
  out << "# " << HeaderStart(unit) << SingleLine(name) << "\no surface\n";
  const int digits = unit == LengthUnit::kMetre ? 9 : 6;  // nanometres
  for (const Eigen::Vector3d& x_m : mesh.vertices_m) {
    const Eigen::Vector3d x = UnitsPerM(unit) * x_m;
    out << fmt::format("v {0:.{3}f} {1:.{3}f} {2:.{3}f}\n", x.x(), x.y(), x.z(), digits);
  }
  for (const Eigen::Vector2d& x : mesh.surface_parameters) {
    out << fmt::format("vt {:.7f} {:.7f}\n", x.x(), x.y());
  }
  for (const Eigen::Vector3d& x : mesh.normals) {
    out << fmt::format("vn {:.7f} {:.7f} {:.7f}\n", x.x(), x.y(), x.z());
  }
  for (const auto& triangle : mesh.triangles) {
    out << 'f';
    for (const int vertex : triangle) {
      const int idx = vertex + 1;
      if (has_normals) {
        out << (has_parameters ? fmt::format(" {0}/{0}/{0}", idx) : fmt::format(" {0}//{0}", idx));
      } else {
        out << (has_parameters ? fmt::format(" {0}/{0}", idx) : fmt::format(" {}", idx));
      }
    }
    out << '\n';
  }
}

void WriteMeshStl(const TriangleMesh& mesh, const std::string& name, LengthUnit unit,
                  std::ostream& out) {
  constexpr std::size_t kHeaderSize = 80;
  // A binary file must not start with "solid", as an ASCII one does.
  std::string bytes = HeaderStart(unit) + SingleLine(name);
  bytes.resize(kHeaderSize, ' ');
  AppendLittleEndian(static_cast<std::uint32_t>(mesh.triangles.size()), &bytes);
  out << bytes;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& x = mesh.vertices_m;
    const Eigen::Vector3d normal = (x[b] - x[a]).cross(x[c] - x[a]).normalized();
    bytes.clear();
    AppendFloats(normal, &bytes);
    for (const int vertex : {a, b, c}) AppendFloats(UnitsPerM(unit) * x[vertex], &bytes);
    bytes.append(2, '\0');
    out << bytes;
  }
}

std::optional<LengthUnit> UnitOfMeshFile(const std::string& beginning) {
  for (const auto& [unit, name] : kLengthUnits) {
    for (const char* comment : {"", "# "}) {
      if (beginning.rfind(comment + HeaderStart(unit), 0) == 0) return unit;
    }
  }
  return std::nullopt;
}

}  // namespace velamap
