#include "exporters/design/cad_reader.h"

#include <fstream>
#include <iterator>
#include <new>

#include <fmt/format.h>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <IGESControl_Reader.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>

#include "exporters/formats/cad_library.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

constexpr double kAngularDeflection = 0.2;  // rad; coarse, so that the chord deviation decides

[[noreturn]] void ThrowUnreadable(const fs::path& path, const char* format) {
  throw InputError(fmt::format("{}: cannot be read as {}; export it again from the CAD program",
                               path.string(), format));
}

[[noreturn]] void ThrowCutOff(const fs::path& path, const char* end) {
  throw InputError(fmt::format("{}: is cut off: it does not end with {}; copy or export it again",
                               path.string(), end));
}

// The last bytes of a file, which hold its end and what may follow.
std::string TailOf(const fs::path& path) {
  constexpr std::uintmax_t kTailSize = 1 << 16;
  const std::uintmax_t size = FileSize(path);
  std::ifstream stream(path, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(size - std::min(size, kTailSize)));
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// Open CASCADE reads a truncated file as far as it goes and reports no error.
void CheckWholeStep(const fs::path& path) {
  const char* end = "END-ISO-10303-21";
  if (TailOf(path).find(end) == std::string::npos) ThrowCutOff(path, end);
}

// The last line of an IGES file has a T in column 73 and the number 1 in columns 74 to 80.
void CheckWholeIges(const fs::path& path) {
  constexpr std::size_t kSize = 8;
  const std::string tail = TailOf(path);
  const std::size_t last = tail.find_last_not_of(" \r\n\x1a");
  const bool has_end = last != std::string::npos && last + 1 >= kSize && tail[last] == '1';
  const std::string end = has_end ? tail.substr(last + 1 - kSize, kSize) : "";
  if (!has_end || end.front() != 'T' || end.find_first_not_of(" 0", 1) != kSize - 1) {
    ThrowCutOff(path, "a terminate section");
  }
}

template <typename Reader>
TopoDS_Shape ReadShape(const fs::path& path, const char* format) {
  Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) ThrowUnreadable(path, format);
  reader.TransferRoots();
  return reader.OneShape();
}

void AddTriangles(const TopoDS_Face& face, TriangleMesh* mesh) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, location);
  if (triangles.IsNull()) return;
  const int first = static_cast<int>(mesh->vertices_m.size());
  for (int i = 1; i <= triangles->NbNodes(); ++i) {
    const gp_Pnt x = triangles->Node(i).Transformed(location.Transformation());
    mesh->vertices_m.push_back(kMPerMm * Eigen::Vector3d(x.X(), x.Y(), x.Z()));
  }
  for (int i = 1; i <= triangles->NbTriangles(); ++i) {
    int a = 0, b = 0, c = 0;
    triangles->Triangle(i).Get(a, b, c);
    if (face.Orientation() == TopAbs_REVERSED) std::swap(b, c);
    mesh->triangles.push_back({first + a - 1, first + b - 1, first + c - 1});
  }
}

TriangleMesh MeshFaces(const TopoDS_Shape& shape, double chord_deviation_mm) {
  TriangleMesh mesh;
  BRepMesh_IncrementalMesh(shape, chord_deviation_mm, Standard_False, kAngularDeflection);
  for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next()) {
    AddTriangles(TopoDS::Face(faces.Current()), &mesh);
  }
  return mesh;
}

}  // namespace

TriangleMesh ReadCad(const fs::path& path, double chord_deviation_mm) {
  VELAMAP_CHECK(chord_deviation_mm > 0);
  const std::string extension = LowerExtension(path);
  const bool is_step = extension == ".step" || extension == ".stp";
  const char* format = is_step ? "STEP" : "IGES";
  is_step ? CheckWholeStep(path) : CheckWholeIges(path);
  const CadSession session;
  try {
    const TopoDS_Shape shape = is_step ? ReadShape<STEPControl_Reader>(path, format)
                                       : ReadShape<IGESControl_Reader>(path, format);
    if (shape.IsNull() || !TopExp_Explorer(shape, TopAbs_FACE).More()) {
      throw InputError(fmt::format("{}: has no faces; export the surface, not its curves or mesh",
                                   path.string()));
    }
    return MeshFaces(shape, chord_deviation_mm);
  } catch (const Standard_OutOfMemory&) {
    throw std::bad_alloc();
  } catch (const Standard_Failure&) {
    ThrowUnreadable(path, format);
  }
}

}  // namespace velamap
