// Structured grids of quadrilaterals on spline surfaces, for simulation: rows of points from luff
// to leech, one row per section from foot to head, at equal steps of the parameters.

#pragma once

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "exporters/formats/length_unit.h"
#include "exporters/formats/surface_spline.h"
#include "importer/base/option.h"

namespace velamap {

struct GridOptions {
  int num_sections = 41;
  int num_points = 41;  // of each section

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(GridOptions* options);

struct SurfaceGrid {
  int num_sections = 0, num_points = 0;
  // Point i of section j is in row j * num_points + i.
  std::vector<Eigen::Vector3d> vertices_m;
  std::vector<Eigen::Vector3d> normals;  // unit
  std::vector<Eigen::Vector2d> surface_parameters;
};

SurfaceGrid MakeGrid(const SplineSurface& surface, const GridOptions& options);

// More data of the points of a grid, by name; finite.
struct GridData {
  std::vector<std::pair<std::string, std::vector<Eigen::Vector3d>>> vectors;
  std::vector<std::pair<std::string, std::vector<double>>> scalars;
};

// VTK StructuredGrid (.vts), XML with ASCII numbers: points in m, and the point data normals, u, v
// and `data`. The first index runs along the sections.
void WriteGridVts(const SurfaceGrid& grid, const std::string& name, std::ostream& out,
                  const GridData& data = {});

// Gmsh 2.2 ASCII: quadrilaterals in a physical surface with the given `name`. A cell with two
// corners in one place becomes a triangle.
void WriteGridMsh(const SurfaceGrid& grid, const std::string& name, LengthUnit unit,
                  std::ostream& out);

// Points as ANSYS DesignModeler reads them for curves: `group point x y z`, one group per section.
void WriteGridAnsys(const SurfaceGrid& grid, const std::string& name, LengthUnit unit,
                    std::ostream& out);

}  // namespace velamap
