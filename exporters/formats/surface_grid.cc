#include "exporters/formats/surface_grid.h"

#include <algorithm>
#include <array>
#include <ostream>

#include <fmt/format.h>

#include "importer/base/csv.h"
#include "importer/text/markup.h"

namespace velamap {
namespace {

constexpr int kMaxGridSize = 2000;

// Adding 0 turns -0 into 0.
std::string Text(const Eigen::Vector3d& x) {
  return fmt::format("{} {} {}", x.x() + 0.0, x.y() + 0.0, x.z() + 0.0);
}

void WriteArray(const std::string& name, const std::vector<Eigen::Vector3d>& values,
                std::ostream& out) {
  out << fmt::format(
      "<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"3\" format=\"ascii\">\n", name);
  for (const Eigen::Vector3d& value : values) out << Text(value) << '\n';
  out << "</DataArray>\n";
}

void WriteArray(const std::string& name, const std::vector<double>& values, std::ostream& out) {
  out << fmt::format("<DataArray type=\"Float64\" Name=\"{}\" format=\"ascii\">\n", name);
  for (const double value : values) out << fmt::format("{}\n", value + 0.0);
  out << "</DataArray>\n";
}

void WriteParameter(const std::string& name, const SurfaceGrid& grid, int axis, std::ostream& out) {
  std::vector<double> values;
  for (const Eigen::Vector2d& parameters : grid.surface_parameters) {
    values.push_back(parameters[axis]);
  }
  WriteArray(name, values, out);
}

// Corners of the cells counter-clockwise seen from where the normals point, each place once.
std::vector<std::vector<int>> Cells(const SurfaceGrid& grid) {
  constexpr double kSamePlace_m = 1e-9;
  std::vector<std::vector<int>> cells;
  for (int j = 0; j + 1 < grid.num_sections; ++j) {
    for (int i = 0; i + 1 < grid.num_points; ++i) {
      const int first = j * grid.num_points + i, above = first + grid.num_points;
      const std::array<int, 4> corners = {first, first + 1, above + 1, above};
      std::vector<int> cell;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Eigen::Vector3d &x = grid.vertices_m[corners[k]],
                              &next = grid.vertices_m[corners[(k + 1) % corners.size()]];
        if ((x - next).norm() > kSamePlace_m) cell.push_back(corners[k]);
      }
      if (cell.size() >= 3) cells.push_back(cell);
    }
  }
  return cells;
}

// Two hyphens end a comment in XML.
std::string CommentText(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return EscapeForMarkup(SingleLine(name));
}

// Quotation marks end a name in Gmsh.
std::string WithoutQuotes(std::string name) {
  std::replace(name.begin(), name.end(), '"', '\'');
  return SingleLine(name);
}

}  // namespace

OptionGroup DescribeOptions(GridOptions* options) {
  return {"Grid of the surface",
          {{"Surface.grid_sections", &options->num_sections, "sections",
            "sections of the grid of quadrilaterals, from foot to head", FromTo(2, kMaxGridSize)},
           {"Surface.grid_points", &options->num_points, "points",
            "points of each of these sections, from luff to leech", FromTo(2, kMaxGridSize)}}};
}

void GridOptions::Check() const { CheckRanges(*this); }

SurfaceGrid MakeGrid(const SplineSurface& surface, const GridOptions& options) {
  options.Check();
  SurfaceGrid grid;
  grid.num_sections = options.num_sections;
  grid.num_points = options.num_points;
  for (int j = 0; j < grid.num_sections; ++j) {
    for (int i = 0; i < grid.num_points; ++i) {
      const double u = i / (grid.num_points - 1.0), v = j / (grid.num_sections - 1.0);
      grid.vertices_m.push_back(EvaluatePoint(surface, u, v));
      grid.normals.push_back(EvaluateNormal(surface, u, v));
      grid.surface_parameters.emplace_back(u, v);
    }
  }
  return grid;
}

void WriteGridVts(const SurfaceGrid& grid, const std::string& name, std::ostream& out,
                  const GridData& data) {
  const std::string extent =
      fmt::format("0 {} 0 {} 0 0", grid.num_points - 1, grid.num_sections - 1);
  out << "<?xml version=\"1.0\"?>\n"
      << "<VTKFile type=\"StructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      << "<!-- velamap surface of " << CommentText(name) << ", unit m -->\n"
      << fmt::format("<StructuredGrid WholeExtent=\"{0}\">\n<Piece Extent=\"{0}\">\n", extent)
      << "<PointData Normals=\"normals\">\n";
  WriteArray("normals", grid.normals, out);
  WriteParameter("u", grid, 0, out);
  WriteParameter("v", grid, 1, out);
  for (const auto& [array, values] : data.vectors) WriteArray(array, values, out);
  for (const auto& [array, values] : data.scalars) WriteArray(array, values, out);
  out << "</PointData>\n<Points>\n";
  WriteArray("points", grid.vertices_m, out);
  out << "</Points>\n</Piece>\n</StructuredGrid>\n</VTKFile>\n";
}

void WriteGridMsh(const SurfaceGrid& grid, const std::string& name, LengthUnit unit,
                  std::ostream& out) {
  constexpr int kTriangle = 2, kQuadrilateral = 3;
  const std::string title = WithoutQuotes(name);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
      << fmt::format("$Comments\nvelamap surface of {}, unit {}\n$EndComments\n", title,
                     ChoiceName(kLengthUnits, unit))
      << fmt::format("$PhysicalNames\n1\n2 1 \"{}\"\n$EndPhysicalNames\n", title)
      << fmt::format("$Nodes\n{}\n", grid.vertices_m.size());
  for (std::size_t i = 0; i < grid.vertices_m.size(); ++i) {
    out << fmt::format("{} {}\n", i + 1, Text(UnitsPerM(unit) * grid.vertices_m[i]));
  }
  const std::vector<std::vector<int>> cells = Cells(grid);
  out << fmt::format("$EndNodes\n$Elements\n{}\n", cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    // The two tags: the physical and the geometrical surface.
    out << fmt::format("{} {} 2 1 1", i + 1, cells[i].size() == 4 ? kQuadrilateral : kTriangle);
    for (const int vertex : cells[i]) out << fmt::format(" {}", vertex + 1);
    out << '\n';
  }
  out << "$EndElements\n";
}

void WriteGridAnsys(const SurfaceGrid& grid, const std::string& name, LengthUnit unit,
                    std::ostream& out) {
  out << fmt::format("# velamap sections of {}, unit {}\n# group point x y z\n", SingleLine(name),
                     ChoiceName(kLengthUnits, unit));
  for (int j = 0; j < grid.num_sections; ++j) {
    for (int i = 0; i < grid.num_points; ++i) {
      const Eigen::Vector3d& x_m = grid.vertices_m[j * grid.num_points + i];
      out << fmt::format("{} {} {}\n", j + 1, i + 1, Text(UnitsPerM(unit) * x_m));
    }
  }
}

}  // namespace velamap
