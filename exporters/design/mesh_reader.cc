#include "exporters/design/mesh_reader.h"

#include <fstream>

#include <fmt/format.h>

#include "exporters/design/mesh_parser.h"
#include "exporters/design/mesh_process.h"
#include "exporters/formats/mesh_writer.h"
#include "importer/base/error.h"
#include "importer/base/files.h"

namespace velamap {

namespace fs = std::filesystem;

bool HasOwnUnit(const fs::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".step" || extension == ".stp" || extension == ".iges" || extension == ".igs";
}

bool IsMeshPath(const fs::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".ply" || extension == ".stl" || extension == ".obj" || HasOwnUnit(path);
}

double DefaultMPerUnit(const fs::path& path) {
  if (LowerExtension(path) == ".ply") return 1.0;
  constexpr std::size_t kEnough = 80;  // the size of the header of an STL
  std::string beginning(kEnough, '\0');
  std::ifstream(path, std::ios::binary).read(beginning.data(), kEnough);
  return 1.0 / UnitsPerM(UnitOfMeshFile(beginning).value_or(LengthUnit::kMillimetre));
}

double MPerUnitFromName(const std::string& name, const std::string& what) {
  if (name == "m") return 1.0;
  if (name == "mm") return 1e-3;
  throw InputError(fmt::format("{}: '{}' is unknown; give m or mm", what, name));
}

TriangleMesh ReadMesh(const fs::path& path, const MeshReadOptions& options) {
  CheckMeshFile(path);
  return ParseMeshInChild(path, options);
}

}  // namespace velamap
