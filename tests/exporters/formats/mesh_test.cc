// Meshes of surfaces and their files, read back by independent readers.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/formats/mesh_triangles.h"
#include "exporters/formats/mesh_writer.h"
#include "importer/base/error.h"
#include "tests/exporters/formats/mesh_area.h"
#include "tests/exporters/formats/ply_reader.h"
#include "tests/exporters/sail/example_surface.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

SplineSurface Sail() { return FitSurface(MarkersOn(TwistedSail, 6, 7)).surface; }

MeshOptions EdgeLength(double mm) {
  MeshOptions options;
  options.edge_length_mm = mm;
  return options;
}

MeshOptions ChordDeviation(double mm) {
  MeshOptions options;
  options.chord_deviation_mm = mm;
  return options;
}

std::string RefusalOf(const SplineSurface& surface, const MeshOptions& options) {
  try {
    MeshSurface(surface, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(Mesh, EdgesAreAsShortAsAskedFor) {
  const TriangleMesh mesh = MeshSurface(Sail(), EdgeLength(100));
  double longest = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& x = mesh.vertices_m;
    longest = std::max({longest, (x[b] - x[a]).norm(), (x[c] - x[b]).norm(), (x[a] - x[c]).norm()});
  }
  EXPECT_LT(longest, 0.15);  // a diagonal
  EXPECT_GT(longest, 0.09);
  EXPECT_NEAR(Area(mesh), SurfaceArea(Sail()), 0.001 * Area(mesh));
}

TEST(Mesh, IsAsNearToTheSurfaceAsAskedFor) {
  for (const double deviation_mm : {20.0, 2.0, 0.5}) {
    const TriangleMesh mesh = MeshSurface(Sail(), ChordDeviation(deviation_mm));
    std::vector<Eigen::Vector3d> points;
    for (const auto& [a, b, c] : mesh.triangles) {
      const auto& x = mesh.vertices_m;
      points.push_back((x[a] + x[b] + x[c]) / 3);
      points.push_back((x[a] + x[c]) / 2);
      points.push_back((x[b] + x[c]) / 2);
    }
    double largest_mm = 0;
    for (const SurfaceFoot& foot : ProjectOnSurface(Sail(), points)) {
      largest_mm = std::max(largest_mm, 1000 * std::abs(foot.distance_m));
    }
    EXPECT_LT(largest_mm, deviation_mm);
    EXPECT_GT(largest_mm, 0.1 * deviation_mm) << "finer than it need be";
  }
}

TEST(Mesh, TrianglesLookWhereTheNormalsDo) {
  const TriangleMesh mesh = MeshSurface(Sail(), EdgeLength(200));
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& x = mesh.vertices_m;
    const Eigen::Vector3d normal = (x[b] - x[a]).cross(x[c] - x[a]).normalized();
    EXPECT_GT(normal.dot(mesh.normals[a]), 0.9);
  }
}

TEST(Mesh, HeadThatIsAPointHasNoTrianglesWithoutArea) {
  SplineSurface surface = Sail();
  for (int i = 0; i < surface.NumPolesU(); ++i) {
    surface.poles_in_shape_m.row((i + 1) * surface.NumPolesV() - 1) =
        Eigen::RowVector3d(0.5, 0.1, 6.3);
  }
  const TriangleMesh mesh = MeshSurface(surface, EdgeLength(300));
  const auto& x = mesh.vertices_m;
  for (const auto& [a, b, c] : mesh.triangles) {
    EXPECT_GT((x[b] - x[a]).cross(x[c] - x[a]).norm(), 1e-9);
  }
  for (const Eigen::Vector3d& normal : mesh.normals) EXPECT_NEAR(normal.norm(), 1, 1e-9);
}

TEST(Mesh, CoarseMeshIsTwoTriangles) {
  EXPECT_EQ(MeshSurface(Sail(), EdgeLength(1e6)).triangles.size(), 2u);
}

TEST(Mesh, AbsurdResolutionIsRefusedWithItsTriangles) {
  // 3 m by 6 m at a micrometre.
  EXPECT_THAT(RefusalOf(Sail(), EdgeLength(1e-3)),
              ::testing::AllOf(HasSubstr("--Surface.edge_length: 0.001 mm would need "),
                               HasSubstr("e+13 triangles, more than 5000000; give")));
  EXPECT_THAT(RefusalOf(Sail(), ChordDeviation(1e-9)),
              HasSubstr("--Surface.chord_deviation: 1e-09 mm"));
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(RefusalOf(Sail(), EdgeLength(bad)), HasSubstr("is out of range; give more than 0"));
  }
  EXPECT_THAT(RefusalOf(Sail(), {}), HasSubstr("give one of the two"));
  MeshOptions both = EdgeLength(10);
  both.chord_deviation_mm = 1;
  EXPECT_THAT(RefusalOf(Sail(), both), HasSubstr("give one of the two"));
}

TEST(Mesh, TheSuggestedResolutionFits) {
  for (const auto& [by_edge, given_mm] : std::vector<std::pair<bool, double>>{
           {true, 0.01}, {true, 1e-300}, {false, 1e-7}, {false, 1e-300}}) {
    const std::string refusal =
        RefusalOf(Sail(), by_edge ? EdgeLength(given_mm) : ChordDeviation(given_mm));
    const double suggested = std::stod(refusal.substr(refusal.find("; give ") + 7));
    const MeshOptions options = by_edge ? EdgeLength(suggested) : ChordDeviation(suggested);
    EXPECT_LT(CountTriangles(Sail(), options), kMaxTriangles);
    EXPECT_GT(CountTriangles(Sail(), options), 0.5 * kMaxTriangles);
  }
}

TEST(MeshWriter, PlyIsInMetresAndWhole) {
  const TriangleMesh mesh = MeshSurface(Sail(), EdgeLength(500));
  std::ostringstream out;
  WriteMeshPly(mesh, "sail", PlyFormat::kBinaryLittleEndian, out);
  EXPECT_THAT(out.str(), HasSubstr("comment velamap surface of sail, unit m\n"));
  const PlyFile file = ReadPly(out.str());
  ASSERT_EQ(file.elements.size(), 2u);
  const auto x = file.elements[0].Column("x"), z = file.elements[0].Column("z");
  const auto nx = file.elements[0].Column("nx"), t = file.elements[0].Column("t");
  ASSERT_EQ(x.size(), mesh.vertices_m.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_EQ(x[i], mesh.vertices_m[i].x());
    EXPECT_EQ(z[i], mesh.vertices_m[i].z());
    EXPECT_EQ(nx[i], static_cast<float>(mesh.normals[i].x()));
    EXPECT_EQ(t[i], static_cast<float>(mesh.surface_parameters[i].y()));
  }
  const auto faces = file.elements[1].ListColumn("vertex_indices");
  ASSERT_EQ(faces.size(), mesh.triangles.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(faces[i][k], mesh.triangles[i][k]);
  }
}

TEST(MeshWriter, PlyLeavesOutWhatTheMeshLacks) {
  TriangleMesh mesh;
  mesh.vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  std::ostringstream out;
  WriteMeshPly(mesh, "a\nb", PlyFormat::kBinaryLittleEndian, out);
  EXPECT_EQ(ReadPly(out.str()).elements[0].properties.size(), 3u);
  EXPECT_THAT(out.str(), HasSubstr("surface of a b, unit m"));
  std::ostringstream obj;
  WriteMeshObj(mesh, "a", LengthUnit::kMillimetre, obj);
  EXPECT_EQ(obj.str(),
            "# velamap, unit mm, surface of a\no surface\nv 0.000000 0.000000 0.000000\n"
            "v 1000.000000 0.000000 0.000000\nv 0.000000 1000.000000 0.000000\nf 1 2 3\n");
}

TEST(MeshWriter, ObjIsInTheUnitAskedFor) {
  const TriangleMesh mesh = MeshSurface(Sail(), EdgeLength(500));
  std::ostringstream out;
  WriteMeshObj(mesh, "sail", LengthUnit::kMetre, out);
  std::istringstream in(out.str());
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "# velamap, unit m, surface of sail");
  std::size_t num_vertices = 0, num_faces = 0;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Eigen::Vector3d x;
      words >> x.x() >> x.y() >> x.z();
      EXPECT_LT((x - mesh.vertices_m[num_vertices++]).norm(), 2e-9);
    } else if (word == "f") {
      words >> word;
      EXPECT_EQ(std::stoi(word) - 1, mesh.triangles[num_faces++][0]);
    }
  }
  EXPECT_EQ(num_vertices, mesh.vertices_m.size());
  EXPECT_EQ(num_faces, mesh.triangles.size());
}

TEST(MeshWriter, StlIsInTheUnitAskedForAndOfTheRightSize) {
  const TriangleMesh mesh = MeshSurface(Sail(), EdgeLength(500));
  std::ostringstream out;
  WriteMeshStl(mesh, "sail", LengthUnit::kMillimetre, out);
  const std::string bytes = out.str();
  ASSERT_EQ(bytes.size(), 84 + 50 * mesh.triangles.size());
  EXPECT_THAT(bytes, StartsWith("velamap, unit mm, surface of sail"));
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(count, mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    float numbers[12];
    std::memcpy(numbers, bytes.data() + 84 + 50 * i, sizeof numbers);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& x = mesh.vertices_m[mesh.triangles[i][k]];
      EXPECT_NEAR(numbers[3 + 3 * k], 1000 * x.x(), 1e-3);
      EXPECT_NEAR(numbers[5 + 3 * k], 1000 * x.z(), 1e-3);
    }
    EXPECT_NEAR(Eigen::Vector3d(numbers[0], numbers[1], numbers[2]).norm(), 1, 1e-6);
  }
}

}  // namespace
}  // namespace velamap
