// Grids of surfaces and their files, read back by VTK's reader (python3-vtk9) and Gmsh, if they are
// installed, and by a parser of our own.

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/formats/surface_grid.h"
#include "importer/base/error.h"
#include "tests/exporters/comma_locale.h"
#include "tests/exporters/sail/example_surface.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using testing::HasSubstr;

SplineSurface GridSail() { return FitSurface(MarkersOn(TwistedSail, 6, 7)).surface; }

GridOptions Size(int num_sections, int num_points) {
  GridOptions options;
  options.num_sections = num_sections;
  options.num_points = num_points;
  return options;
}

double Area(const SurfaceGrid& grid) {
  double area_m2 = 0.0;
  const auto& x = grid.vertices_m;
  for (int j = 0; j + 1 < grid.num_sections; ++j) {
    for (int i = 0; i + 1 < grid.num_points; ++i) {
      const int k = j * grid.num_points + i, above = k + grid.num_points;
      area_m2 += (x[above + 1] - x[k]).cross(x[above] - x[k + 1]).norm() / 2;
    }
  }
  return area_m2;
}

TEST(SurfaceGrid, RunsFromLuffToLeechAndFromFootToHead) {
  const SplineSurface surface = GridSail();
  const SurfaceGrid grid = MakeGrid(surface, Size(5, 9));
  ASSERT_EQ(grid.vertices_m.size(), 45u);
  for (int j = 0; j < 5; ++j) {
    for (int i = 0; i < 9; ++i) {
      const Eigen::Vector3d expected = EvaluatePoint(surface, i / 8.0, j / 4.0);
      EXPECT_LT((grid.vertices_m[9 * j + i] - expected).norm(), 1e-12);
    }
  }
  EXPECT_GT(grid.vertices_m.back().z(), grid.vertices_m.front().z());
  EXPECT_NEAR(Area(MakeGrid(surface, Size(60, 60))), SurfaceArea(surface), 1e-3);
  ExpectThrows<InputError>([&] { MakeGrid(surface, Size(1, 9)); }, {"--Surface.grid_sections"});
  ExpectThrows<InputError>([&] { MakeGrid(surface, Size(9, 0)); }, {"--Surface.grid_points"});
}

TEST(SurfaceGrid, FilesDoNotDependOnTheLocale) {
  const SurfaceGrid grid = MakeGrid(GridSail(), Size(3, 4));
  const auto text = [&] {
    std::ostringstream out;
    WriteGridVts(grid, "a--b<", out);
    WriteGridMsh(grid, "a\"b", LengthUnit::kMetre, out);
    WriteGridAnsys(grid, "a\nb", LengthUnit::kMetre, out);
    return out.str();
  };
  const std::string expected = text();
  EXPECT_THAT(expected, HasSubstr("surface of a__b&lt;, unit m -->"));
  EXPECT_THAT(expected, HasSubstr("2 1 \"a'b\"\n"));
  EXPECT_THAT(expected, HasSubstr("# velamap sections of a b, unit m\n"));
  const CommaLocale comma;
  EXPECT_EQ(text(), expected);
}

TEST(SurfaceGrid, AnsysPointsAreOneGroupPerSectionInTheUnit) {
  const SurfaceGrid grid = MakeGrid(GridSail(), Size(3, 4));
  std::stringstream file;
  WriteGridAnsys(grid, "sail", LengthUnit::kMillimetre, file);
  std::string comment;
  std::getline(file, comment);
  EXPECT_THAT(comment, HasSubstr("unit mm"));
  std::getline(file, comment);
  int group = 0, point = 0;
  std::size_t count = 0;
  Eigen::Vector3d x_mm;
  while (file >> group >> point >> x_mm.x() >> x_mm.y() >> x_mm.z()) {
    EXPECT_EQ(group, static_cast<int>(count / 4) + 1);
    EXPECT_EQ(point, static_cast<int>(count % 4) + 1);
    EXPECT_LT((1e-3 * x_mm - grid.vertices_m.at(count++)).norm(), 1e-12);
  }
  EXPECT_EQ(count, 12u);
}

// A head that is a point, but for what a fit leaves of it: its quadrilaterals have become triangles
// with one node at the head, and none has two corners in one place.
TEST(SurfaceGrid, MshOfAPointedHeadHasTriangles) {
  SplineSurface surface = GridSail();
  for (int i = 0; i < surface.NumPolesU(); ++i) {
    surface.poles_in_shape_m.row((i + 1) * surface.NumPolesV() - 1) =
        Eigen::RowVector3d(0.5 + 1e-6 * i, 0.1, 6.3);
  }
  std::stringstream file;
  WriteGridMsh(MakeGrid(surface, Size(4, 5)), "sail", LengthUnit::kMetre, file);
  std::string line;
  while (std::getline(file, line) && line != "$Elements") continue;
  int num_elements = 0, num_triangles = 0;
  std::set<int> heads;
  ASSERT_TRUE(file >> num_elements);
  for (int i = 0; i < num_elements; ++i) {
    int number = 0, type = 0, num_tags = 0, tag = 0, node = 0;
    file >> number >> type >> num_tags >> tag >> tag;
    num_triangles += type == 2;
    std::set<int> nodes;
    for (int k = 0; k < (type == 2 ? 3 : 4); ++k) {
      ASSERT_TRUE(file >> node);
      nodes.insert(node);
    }
    EXPECT_EQ(nodes.size(), type == 2 ? 3u : 4u);
    if (type == 2) heads.insert(*nodes.rbegin());
  }
  EXPECT_EQ(num_elements, 12);
  EXPECT_EQ(num_triangles, 4);
  EXPECT_EQ(heads.size(), 1u);
}

// Runs a command in `dir` and returns what it wrote to result.txt.
std::string ResultOf(const TempDir& dir, const std::string& command) {
  const std::string folder = dir.path().string();
  const int status =
      std::system(("cd '" + folder + "' && timeout 120 " + command + " > log.txt 2>&1").c_str());
  std::ostringstream log, result;
  log << std::ifstream(dir / "log.txt").rdbuf();
  EXPECT_EQ(status, 0) << log.str();
  result << std::ifstream(dir / "result.txt").rdbuf();
  return result.str();
}

bool Works(const std::string& command) {
  return std::system((command + " > /dev/null 2>&1").c_str()) == 0;
}

TEST(SurfaceGrid, VtkReadsTheStructureAndTheNormals) {
  if (!Works("/usr/bin/python3 -c 'import vtkmodules.vtkIOXML'")) GTEST_SKIP() << "no python3-vtk9";
  const TempDir dir;
  const SurfaceGrid grid = MakeGrid(GridSail(), Size(21, 31));
  std::ofstream file(dir / "a.vts");
  WriteGridVts(grid, "sail -- <1>", file);
  file.close();
  std::ofstream(dir / "read.py") << R"(
from vtkmodules.vtkIOXML import vtkXMLStructuredGridReader
reader = vtkXMLStructuredGridReader()
reader.SetFileName("a.vts")
reader.Update()
grid = reader.GetOutput()
dimensions = [0, 0, 0]
grid.GetDimensions(dimensions)
data = grid.GetPointData()
numbers = [*dimensions, *grid.GetPoint(32), *data.GetNormals().GetTuple(32),
           data.GetArray("u").GetValue(32), data.GetArray("v").GetValue(32),
           grid.GetNumberOfCells()]
open("result.txt", "w").write(" ".join("%.17g" % number for number in numbers))
)";
  std::istringstream result(ResultOf(dir, "/usr/bin/python3 read.py"));
  std::vector<double> numbers;
  for (double number = 0; result >> number;) numbers.push_back(number);
  ASSERT_EQ(numbers.size(), 12u);
  EXPECT_THAT(std::vector<double>(numbers.begin(), numbers.begin() + 3),
              testing::ElementsAre(31, 21, 1));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(numbers[3 + axis], grid.vertices_m[32][axis]);
    EXPECT_EQ(numbers[6 + axis], grid.normals[32][axis]);
  }
  EXPECT_EQ(numbers[9], grid.surface_parameters[32].x());
  EXPECT_EQ(numbers[10], grid.surface_parameters[32].y());
  EXPECT_EQ(numbers[11], 20 * 30);  // cells
}

TEST(SurfaceGrid, GmshReadsTheMesh) {
  if (!Works("command -v gmsh")) GTEST_SKIP() << "no gmsh";
  const TempDir dir;
  const SurfaceGrid grid = MakeGrid(GridSail(), Size(11, 21));
  std::ofstream file(dir / "a.msh");
  WriteGridMsh(grid, "sail (frame: lines h1 v1)", LengthUnit::kMillimetre, file);
  file.close();
  // Gmsh reads the mesh and writes it as STL, whose area has to be that of the grid.
  ResultOf(dir, "gmsh a.msh -save -format stl -o out.stl");
  std::ifstream stl(dir / "out.stl");
  std::string word;
  double area_mm2 = 0.0;
  int num_triangles = 0;
  std::vector<Eigen::Vector3d> corners;
  while (stl >> word) {
    if (word != "vertex") continue;
    corners.emplace_back();
    stl >> corners.back().x() >> corners.back().y() >> corners.back().z();
    if (corners.size() < 3) continue;
    area_mm2 += (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 2;
    corners.clear();
    ++num_triangles;
  }
  EXPECT_EQ(num_triangles, 2 * 10 * 20);
  EXPECT_NEAR(1e-6 * area_mm2, Area(grid), 1e-3 * Area(grid));
}

}  // namespace
}  // namespace velamap
