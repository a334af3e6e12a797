#include "exporters/formats/surface_grid.h"

#include <algorithm>
#include <ostream>

#include <fmt/format.h>

#include "importer/text/csv.h"
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

// For each vertex, the first one of its section or its column in the same place: edges that are
// far shorter than the others are a point, as at the head of a sail that ends in one.
std::vector<int> SamePlaces(const SurfaceGrid& grid) {
  constexpr double kSamePlace = 1e-3;  // of the mean length of the edges along sections
  double mean_m = 0.0;
  const auto count = static_cast<int>(grid.vertices_m.size());
  const auto distance = [&grid](int a, int b) {
    return (grid.vertices_m[static_cast<std::size_t>(a)] -
            grid.vertices_m[static_cast<std::size_t>(b)])
        .norm();
  };
  for (int k = 1; k < count; ++k) {
    if (k % grid.num_points != 0) mean_m += distance(k - 1, k) / count;
  }
  std::vector<int> places(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    int& place = places[static_cast<std::size_t>(k)];
    place = k;
    for (const int before : {k % grid.num_points != 0 ? k - 1 : -1, k - grid.num_points}) {
      if (before >= 0 && distance(before, k) < kSamePlace * mean_m) {
        place = places[static_cast<std::size_t>(before)];
        break;
      }
    }
  }
  return places;
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
  const std::vector<int> places = SamePlaces(grid);
  std::vector<std::vector<int>> cells;
  for (int j = 0; j + 1 < grid.num_sections; ++j) {
    for (int i = 0; i + 1 < grid.num_points; ++i) {
      const int first = j * grid.num_points + i, above = first + grid.num_points;
      std::vector<int> cell;
      for (const int corner : {first, first + 1, above + 1, above}) {
        const int place = places[static_cast<std::size_t>(corner)];
        if (std::find(cell.begin(), cell.end(), place) == cell.end()) cell.push_back(place);
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
