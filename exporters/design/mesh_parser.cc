#include "exporters/design/mesh_parser.h"

#include <algorithm>
#include <fstream>
#include <string>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <Eigen/Geometry>
#include <assimp/Importer.hpp>

#include "exporters/design/cad_reader.h"
#include "importer/base/error.h"
#include "importer/base/files.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

// Assimp does not terminate on a PLY file whose header does not end in a separate line.
bool HasWholePlyHeader(const fs::path& path) {
  constexpr int kMaxHeaderLines = 10000;
  std::ifstream stream(path, std::ios::binary);
  std::string line;
  for (int i = 0; i < kMaxHeaderLines && std::getline(stream, line); ++i) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line == "end_header") return !stream.eof();
  }
  return false;
}

[[noreturn]] void ThrowUnreadable(const fs::path& path, std::string reason) {
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  throw InputError(fmt::format("{}: cannot be read as {} with faces ({}); export it again",
                               path.string(), LowerExtension(path).substr(1), reason));
}

void AppendTriangles(const aiMesh& part, double m_per_unit, TriangleMesh* mesh) {
  const int first = static_cast<int>(mesh->vertices_m.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& x = part.mVertices[i];
    mesh->vertices_m.push_back(m_per_unit * Eigen::Vector3d(x.x, x.y, x.z));
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;
    const auto vertex = [&](int k) { return first + static_cast<int>(face.mIndices[k]); };
    mesh->triangles.push_back({vertex(0), vertex(1), vertex(2)});
  }
}

TriangleMesh ReadWithAssimp(const fs::path& path, double m_per_unit) {
  if (LowerExtension(path) == ".ply" && !HasWholePlyHeader(path)) {
    ThrowUnreadable(path, "its header does not end");
  }
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene =
      importer.ReadFile(path.string(), aiProcess_Triangulate | aiProcess_SortByPType |
                                           aiProcess_ValidateDataStructure);
  if (scene == nullptr) ThrowUnreadable(path, importer.GetErrorString());
  TriangleMesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    AppendTriangles(*scene->mMeshes[i], m_per_unit, &mesh);
  }
  return mesh;
}

bool HasArea(const TriangleMesh& mesh) {
  const auto& x = mesh.vertices_m;
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    const auto vertex = [&](std::size_t k) { return x[static_cast<std::size_t>(t[k])]; };
    return (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).squaredNorm() > 0;
  });
}

}  // namespace

void CheckMeshFile(const fs::path& path) {
  if (!IsMeshPath(path)) {
    throw InputError(
        fmt::format("{}: unknown extension; expected .ply, .stl, .obj, .step, .stp, .iges or .igs",
                    path.string()));
  }
  if (!Exists(path)) throw InputError(fmt::format("{}: no such file", path.string()));
  if (!IsRegularFile(path)) {
    throw InputError(fmt::format("{}: not a regular file", path.string()));
  }
  if (FileSize(path) > kMaxMeshFileSize) {
    throw InputError(
        fmt::format("{}: has {} bytes; files of at most {} are read; export a coarser "
                    "mesh",
                    path.string(), FileSize(path), kMaxMeshFileSize));
  }
}

TriangleMesh ParseMesh(const fs::path& path, const MeshReadOptions& options) {
  const TriangleMesh mesh =
      HasOwnUnit(path) ? ReadCad(path, options.chord_deviation_mm)
                       : ReadWithAssimp(path, options.m_per_unit.value_or(DefaultMPerUnit(path)));
  const bool is_finite = std::all_of(mesh.vertices_m.begin(), mesh.vertices_m.end(),
                                     [](const Eigen::Vector3d& x) { return x.allFinite(); });
  if (!is_finite) {
    throw InputError(fmt::format("{}: a coordinate is not finite; export it again", path.string()));
  }
  const std::size_t num_elements = std::max(mesh.vertices_m.size(), mesh.triangles.size());
  if (num_elements > kMaxMeshElements) {
    throw InputError(fmt::format(
        "{}: has {} vertices and {} triangles; at most {} of each are read; export a coarser mesh",
        path.string(), mesh.vertices_m.size(), mesh.triangles.size(), kMaxMeshElements));
  }
  if (!HasArea(mesh)) {
    throw InputError(fmt::format(
        "{}: has no triangles; export the surface, not its points or curves", path.string()));
  }
  return mesh;
}

}  // namespace velamap
