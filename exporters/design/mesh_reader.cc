#include "exporters/design/mesh_reader.h"

#include <fstream>

#include <fmt/format.h>

#include "exporters/design/mesh_parser.h"
#include "exporters/design/mesh_process.h"
#include "exporters/formats/float_step.h"
#include "exporters/formats/mesh_writer.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/geometry/units.h"

namespace velamap {

namespace fs = std::filesystem;

namespace {

// Assimp holds coordinates as 32-bit floats, whatever the file has.
void CheckFloatStep(const fs::path& path, const TriangleMesh& mesh) {
  constexpr double kUselessStep_m = 1e-3;
  const std::optional<double> step_m = CoarseFloatStep_m(mesh.vertices_m);
  if (!step_m) return;
  const std::string problem = fmt::format(
      "{}: its coordinates are so far from the origin that they are read in steps of {:.3g} mm; "
      "export it in a frame near the object, or as STEP",
      path.string(), kMmPerM * *step_m);
  if (*step_m > kUselessStep_m) throw InputError(problem);
  LogWarning(problem);
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
  TriangleMesh mesh = ParseMeshInChild(path, options);
  if (!HasOwnUnit(path)) CheckFloatStep(path, mesh);
  return mesh;
}

}  // namespace velamap
