#include "exporters/design/mesh_process.h"

#include <fstream>

#include <gtest/gtest.h>

#include "exporters/design/mesh_parser.h"
#include "exporters/formats/cad_writer.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "tests/exporters/sail/example_surface.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

class MeshProcessTest : public ::testing::Test {
 protected:
  MeshProcessTest() {
    const SplineSurface surface = FitSurface(MarkersOn(BilinearPatch, 4, 5)).surface;
    WriteFileAtomically(step_, [&](std::ostream& out) { WriteStep(surface, "a", out); });
  }

  TempDir dir_;
  std::filesystem::path step_ = dir_ / "a.step";
  MeshReadOptions options_;
};

TEST_F(MeshProcessTest, GivesWhatTheParserGives) {
  const TriangleMesh expected = ParseMesh(step_, options_);
  const TriangleMesh mesh = ParseMeshInChild(step_, options_);
  EXPECT_EQ(mesh.vertices_m, expected.vertices_m);
  EXPECT_EQ(mesh.triangles, expected.triangles);
  options_.chord_deviation_mm = 5.0;
  EXPECT_LT(ParseMeshInChild(step_, options_).triangles.size(), mesh.triangles.size());
}

TEST_F(MeshProcessTest, UnitIsPassedOn) {
  std::ofstream(dir_ / "a.obj") << "v 0 0 0\nv 2 0 0\nv 2 3 0\nf 1 2 3\n";
  options_.m_per_unit = 0.1;
  EXPECT_NEAR(ParseMeshInChild(dir_ / "a.obj", options_).vertices_m[1].x(), 0.2, 1e-9);
}

TEST_F(MeshProcessTest, EndsWhatTakesTooLong) {
  options_.chord_deviation_mm = 1e-7;
  MeshLimits limits;
  limits.cpu_s = 1;
  ExpectThrows<InputError>([&] { ParseMeshInChild(step_, options_, limits); },
                           {"a.step", "more than 1 s", "export it again"});
}

TEST_F(MeshProcessTest, EndsWhatWaits) {
  MeshLimits limits;
  limits.wall_s = 0;
  ExpectThrows<InputError>([&] { ParseMeshInChild(step_, options_, limits); }, {"a.step"});
}

#ifndef VELAMAP_SANITIZE
TEST_F(MeshProcessTest, EndsWhatTakesTooMuchMemory) {
  const std::uint32_t num_triangles = 4'000'000;
  const std::uintmax_t header_size = 84, triangle_size = 50;
  std::ofstream stl(dir_ / "a.stl", std::ios::binary);
  stl.seekp(80);
  stl.write(reinterpret_cast<const char*>(&num_triangles), sizeof(num_triangles));
  stl.close();
  std::filesystem::resize_file(dir_ / "a.stl", header_size + num_triangles * triangle_size);
  MeshLimits limits;
  limits.memory_bytes = std::uint64_t{400} << 20;
  ExpectThrows<InputError>(
      [&] { ParseMeshInChild(dir_ / "a.stl", options_, limits); },
      {"a.stl: reading it takes more than 400 MB of memory", "export it again"});
}
#endif

}  // namespace
}  // namespace velamap
