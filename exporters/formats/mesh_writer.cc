#include "exporters/formats/mesh_writer.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <ostream>

#include <fmt/format.h>
#include <Eigen/Geometry>

namespace velamap {
namespace {

constexpr double kMmPerM = 1000.0;

// Least significant byte first on every machine.
template <typename Bits, typename T>
void AppendLittleEndian(T value, std::string* bytes) {
  static_assert(sizeof(Bits) == sizeof(T));
  Bits bits;
  std::memcpy(&bits, &value, sizeof bits);
  for (std::size_t i = 0; i < sizeof bits; ++i) {
    bytes->push_back(static_cast<char>(bits >> (8 * i)));
  }
}

void AppendDouble(double value, std::string* bytes) {
  AppendLittleEndian<std::uint64_t>(value, bytes);
}

void AppendFloat(double value, std::string* bytes) {
  AppendLittleEndian<std::uint32_t>(static_cast<float>(value), bytes);
}

std::string OneLine(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return name;
}

}  // namespace

void WriteMeshPly(const TriangleMesh& mesh, const std::string& name, std::ostream& out) {
  const bool has_normals = !mesh.normals.empty();
  const bool has_parameters = !mesh.surface_parameters.empty();
  out << "ply\nformat binary_little_endian 1.0\ncomment velamap surface of " << OneLine(name)
      << ", unit m\nelement vertex " << fmt::to_string(mesh.vertices_m.size())
      << "\nproperty double x\nproperty double y\nproperty double z\n";
  if (has_normals) out << "property float nx\nproperty float ny\nproperty float nz\n";
  if (has_parameters) out << "property float s\nproperty float t\n";
  out << "element face " << fmt::to_string(mesh.triangles.size())
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  std::string bytes;
  for (std::size_t i = 0; i < mesh.vertices_m.size(); ++i) {
    bytes.clear();
    for (const double x : mesh.vertices_m[i]) AppendDouble(x, &bytes);
    if (has_normals) {
      for (const double x : mesh.normals[i]) AppendFloat(x, &bytes);
    }
    if (has_parameters) {
      for (const double x : mesh.surface_parameters[i]) AppendFloat(x, &bytes);
    }
    out << bytes;
  }
  for (const auto& triangle : mesh.triangles) {
    bytes.assign(1, '\3');
    for (const int vertex : triangle) AppendLittleEndian<std::uint32_t>(vertex, &bytes);
    out << bytes;
  }
}

void WriteMeshObj(const TriangleMesh& mesh, const std::string& name, std::ostream& out) {
  const bool has_normals = !mesh.normals.empty();
  const bool has_parameters = !mesh.surface_parameters.empty();
  out << "# velamap surface of " << OneLine(name) << ", unit mm\no surface\n";
  for (const Eigen::Vector3d& x : mesh.vertices_m) {
    out << fmt::format("v {:.6f} {:.6f} {:.6f}\n", kMmPerM * x.x(), kMmPerM * x.y(),
                       kMmPerM * x.z());
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

void WriteMeshStl(const TriangleMesh& mesh, const std::string& name, std::ostream& out) {
  constexpr std::size_t kHeaderSize = 80;
  // A binary file must not start with "solid", which begins the text form.
  std::string bytes = "velamap, unit mm, surface of " + OneLine(name);
  bytes.resize(kHeaderSize, ' ');
  AppendLittleEndian<std::uint32_t>(static_cast<std::uint32_t>(mesh.triangles.size()), &bytes);
  out << bytes;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& x = mesh.vertices_m;
    const Eigen::Vector3d normal = (x[b] - x[a]).cross(x[c] - x[a]).normalized();
    bytes.clear();
    for (const double value : normal) AppendFloat(value, &bytes);
    for (const int vertex : {a, b, c}) {
      for (const double value : x[vertex]) AppendFloat(kMmPerM * value, &bytes);
    }
    bytes.append(2, '\0');
    out << bytes;
  }
}

}  // namespace velamap
