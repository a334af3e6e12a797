#include "exporters/design/mesh_reader.h"

#include <fstream>
#include <functional>
#include <random>
#include <sstream>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/design/mesh_parser.h"
#include "exporters/design/mesh_process.h"
#include "exporters/formats/cad_writer.h"
#include "exporters/formats/mesh_writer.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/exporters/formats/mesh_area.h"
#include "tests/exporters/sail/example_surface.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

class MeshReaderTest : public ::testing::Test {
 protected:
  fs::path Write(const std::string& name, const std::string& text) {
    std::ofstream(dir_ / name, std::ios::binary) << text;
    return dir_ / name;
  }
  void ExpectRefused(const fs::path& path, std::initializer_list<std::string> parts) {
    ExpectThrows<InputError>([&] { ReadMesh(path); }, parts);
  }

  TempDir dir_;
};

TEST_F(MeshReaderTest, ReadsBackWhatVelamapWritesInTheRightUnit) {
  const TriangleMesh mesh = SailMesh();
  constexpr LengthUnit kM = LengthUnit::kMetre, kMm = LengthUnit::kMillimetre;
  const std::vector<std::pair<std::string, std::function<void(std::ostream&)>>> writers = {
      {"a.ply",
       [&](std::ostream& out) { WriteMeshPly(mesh, "sail", PlyFormat::kBinaryLittleEndian, out); }},
      {"a.OBJ", [&](std::ostream& out) { WriteMeshObj(mesh, "sail", kM, out); }},
      {"b.obj", [&](std::ostream& out) { WriteMeshObj(mesh, "unit mm", kMm, out); }},
      {"a.stl", [&](std::ostream& out) { WriteMeshStl(mesh, "unit mm", kM, out); }},
      {"b.stl", [&](std::ostream& out) { WriteMeshStl(mesh, "sail", kMm, out); }}};
  for (const auto& [name, writer] : writers) {
    WriteFileAtomically(dir_ / name, writer);
    const TriangleMesh read = ReadMesh(dir_ / name);
    EXPECT_EQ(read.triangles.size(), mesh.triangles.size()) << name;
    EXPECT_NEAR(Area(read), Area(mesh), 1e-4) << name;
    // The normal points to the same side at the same place.
    const auto& [a, b, c] = read.triangles.front();
    const auto& [d, e, f] = mesh.triangles.front();
    EXPECT_LT((read.vertices_m[a] - mesh.vertices_m[d]).norm(), 1e-5) << name;
    EXPECT_GT((read.vertices_m[b] - read.vertices_m[a])
                  .cross(read.vertices_m[c] - read.vertices_m[a])
                  .dot((mesh.vertices_m[e] - mesh.vertices_m[d])
                           .cross(mesh.vertices_m[f] - mesh.vertices_m[d])),
              0)
        << name;
  }
}

TEST_F(MeshReaderTest, MeshesWhereFloatsAreTooCoarseAreRefused) {
  const auto write = [&](const std::string& name, double easting_m) {
    TriangleMesh mesh = SailMesh();
    for (Eigen::Vector3d& x_m : mesh.vertices_m) x_m.x() += easting_m;
    WriteFileAtomically(dir_ / name, [&](std::ostream& out) {
      WriteMeshPly(mesh, "sail", PlyFormat::kBinaryLittleEndian, out);
    });
    return dir_ / name;
  };
  ExpectRefused(write("grid.ply", 5423456),
                {"grid.ply", "steps of 647 mm", "a frame near the object, or as STEP"});
  EXPECT_FALSE(ReadMesh(write("harbour.ply", 1000)).triangles.empty());  // with a warning
}

TEST_F(MeshReaderTest, StepAndIgesHaveTheirUnit) {
  const SplineSurface surface = FitSurface(MarkersOn(BilinearPatch, 4, 5)).surface;
  WriteFileAtomically(dir_ / "a.step", [&](std::ostream& out) { WriteStep(surface, "a", out); });
  WriteFileAtomically(dir_ / "a.igs", [&](std::ostream& out) { WriteIges(surface, "a", out); });
  for (const char* name : {"a.step", "a.igs"}) {
    EXPECT_NEAR(Area(ReadMesh(dir_ / name)), SurfaceArea(surface), 0.01) << name;
    EXPECT_TRUE(HasOwnUnit(dir_ / name));
  }
}

// Open CASCADE reads what there is of these, Assimp hangs on the header.
TEST_F(MeshReaderTest, CutOffFiles) {
  const SplineSurface surface = FitSurface(MarkersOn(BilinearPatch, 4, 5)).surface;
  const TriangleMesh mesh = SailMesh();
  std::ostringstream step, iges, ply, stl;
  WriteStep(surface, "a", step);
  WriteIges(surface, "a", iges);
  WriteMeshPly(mesh, "a", PlyFormat::kBinaryLittleEndian, ply);
  WriteMeshStl(mesh, "a", LengthUnit::kMetre, stl);
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.step", step.str()}, {"a.iges", iges.str()}, {"a.ply", ply.str()}, {"a.stl", stl.str()}};
  for (const auto& [name, text] : files) {
    Write(name, text);
    EXPECT_GT(Area(ReadMesh(dir_ / name)), 0) << name;
    for (const double share : {0.3, 0.5, 0.7, 0.98}) {
      const auto size = static_cast<std::size_t>(share * static_cast<double>(text.size()));
      ExpectRefused(Write("cut_" + name, text.substr(0, size)), {"cut_" + name});
    }
  }
}

TEST_F(MeshReaderTest, HeaderOfPlyThatDoesNotEnd) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header";
  const std::string body = "\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(ReadMesh(Write("good.ply", text + body)).triangles.size(), 1u);
  EXPECT_EQ(ReadMesh(Write("dos.ply", text + "\r" + body)).triangles.size(), 1u);
  for (const char* end : {",", " ", "\t", "s"}) {
    ExpectRefused(Write("a.ply", text + end + body), {"a.ply", "header does not end"});
  }
}

TEST_F(MeshReaderTest, LargeFiles) {
  Write("a.ply", "ply\n");
  fs::resize_file(dir_ / "a.ply", kMaxMeshFileSize + 1);
  ExpectRefused(dir_ / "a.ply", {"a.ply", "at most"});
}

// Open CASCADE crashes on some of these.
TEST_F(MeshReaderTest, WrongBytesInStepAreRefusedOrRead) {
  const SplineSurface surface = FitSurface(MarkersOn(BilinearPatch, 4, 5)).surface;
  std::ostringstream step;
  WriteStep(surface, "a", step);
  MeshLimits limits;
  limits.cpu_s = 2;
  limits.wall_s = 10;
  std::mt19937 random(1);
  for (int i = 0; i < 25; ++i) {
    std::string text = step.str();
    text[random() % text.size()] = "#,(0$Z'"[random() % 7];
    const fs::path path = Write("a.step", text);
    try {
      EXPECT_GT(ParseMeshInChild(path, {}, limits).triangles.size(), 0u);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind(path.string(), 0), 0u) << error.what();
    }
  }
}

TEST_F(MeshReaderTest, UnitThatIsGivenCounts) {
  const fs::path path = Write("a.obj", "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nf 1 2 3 4\n");
  EXPECT_NEAR(Area(ReadMesh(path)), 6e-6, 1e-12);
  MeshReadOptions options;
  options.m_per_unit = MPerUnitFromName("m", "--reference_unit");
  EXPECT_NEAR(Area(ReadMesh(path, options)), 6.0, 1e-6);  // the quadrilateral whole
  ExpectThrows<InputError>([] { MPerUnitFromName("inch", "--reference_unit"); },
                           {"--reference_unit", "inch", "mm"});
}

TEST_F(MeshReaderTest, BadFiles) {
  ExpectRefused(dir_ / "no.stl", {"no.stl", "no such file"});
  ExpectRefused(Write("a.xyz", "0 0 0\n"), {"a.xyz", "expected .ply"});
  ExpectRefused(Write("a", "0 0 0\n"), {"expected .ply"});
  fs::create_directory(dir_ / "folder.stl");
  ExpectRefused(dir_ / "folder.stl", {"folder.stl", "not a regular file"});
  ExpectRefused(Write("empty.ply", ""), {"empty.ply", "cannot be read as ply"});
  ExpectRefused(Write("text.stl", "this is no mesh\n"), {"text.stl"});
  ExpectRefused(Write("text.step", "this is no mesh\n"), {"text.step", "ISO-10303-21"});
  ExpectRefused(Write("end.step", "no mesh\nEND-ISO-10303-21;\n"), {"end.step", "as STEP"});
  ExpectRefused(Write("cut.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"),
                {"cut.ply"});
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  ExpectRefused(Write("head.ply", header), {"head.ply"});
  ExpectRefused(Write("body.ply", header + "0 0 0\n1 1 1\n"), {"body.ply"});
  std::string binary = header + std::string(20, '\0');
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  ExpectRefused(Write("binary.ply", binary), {"binary.ply"});
  ExpectRefused(Write("points.ply",
                      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float "
                      "y\nproperty float z\nend_header\n0 0 0\n1 1 1\n"),
                {"points.ply"});
  ExpectRefused(Write("lines.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nl 1 2 3\n"), {"lines.obj"});
  ExpectRefused(Write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
                {"flat.obj", "has no triangles"});
  ExpectRefused(Write("nan.obj", "v 0 0 0\nv nan 0 0\nv 2 1 0\nf 1 2 3\n"), {"nan.obj"});
  ExpectRefused(Write("range.obj", "v 0 0 0\nv 1 0 0\nv 2 1 0\nf 1 2 9\n"), {"range.obj"});
}

}  // namespace
}  // namespace velamap
