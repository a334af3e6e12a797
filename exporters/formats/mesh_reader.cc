#include "exporters/formats/mesh_reader.h"

#include <algorithm>
#include <fstream>
#include <string>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <Eigen/Geometry>
#include <assimp/Importer.hpp>

#include "exporters/formats/cad_reader.h"
#include "importer/base/error.h"
#include "importer/base/files.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

void CheckFile(const fs::path& path) {
  if (!Exists(path)) {
    throw InputError(fmt::format("{}: no such file", path.string()));
  }
  if (!IsRegularFile(path)) {
    throw InputError(fmt::format("{}: not a regular file", path.string()));
  }
}

// Assimp does not terminate on a PLY file whose header does not end.
bool HasWholePlyHeader(const fs::path& path) {
  constexpr int kMaxHeaderLines = 10000;
  std::ifstream stream(path, std::ios::binary);
  std::string line;
  for (int i = 0; i < kMaxHeaderLines && std::getline(stream, line); ++i) {
    if (line.rfind("end_header", 0) == 0) return !stream.eof();
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

bool HasOwnUnit(const fs::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".step" || extension == ".stp" || extension == ".iges" || extension == ".igs";
}

bool IsMeshPath(const fs::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".ply" || extension == ".stl" || extension == ".obj" || HasOwnUnit(path);
}

double DefaultMPerUnit(const fs::path& path) { return LowerExtension(path) == ".ply" ? 1.0 : 1e-3; }

double MPerUnitFromName(const std::string& name, const std::string& what) {
  if (name == "m") return 1.0;
  if (name == "mm") return 1e-3;
  throw InputError(fmt::format("{}: '{}' is unknown; give m or mm", what, name));
}

TriangleMesh ReadMesh(const fs::path& path, const MeshReadOptions& options) {
  if (!IsMeshPath(path)) {
    throw InputError(
        fmt::format("{}: unknown extension; expected .ply, .stl, .obj, .step, .stp, .iges or .igs",
                    path.string()));
  }
  CheckFile(path);
  const TriangleMesh mesh =
      HasOwnUnit(path) ? ReadCad(path, options.chord_deviation_mm).mesh
                       : ReadWithAssimp(path, options.m_per_unit.value_or(DefaultMPerUnit(path)));
  const bool is_finite = std::all_of(mesh.vertices_m.begin(), mesh.vertices_m.end(),
                                     [](const Eigen::Vector3d& x) { return x.allFinite(); });
  if (!is_finite) {
    throw InputError(fmt::format("{}: a coordinate is not finite; export it again", path.string()));
  }
  if (!HasArea(mesh)) {
    throw InputError(fmt::format(
        "{}: has no triangles; export the surface, not its points or curves", path.string()));
  }
  return mesh;
}

}  // namespace velamap
