// The deflection of a sail: the vectors from the points of a grid on the reference's surface to the
// surface of the compared shape.
//
// Between two shapes, the vector joins the points of the two surfaces (FitSurface) with the same u
// and v, both fitted to the markers that both shapes have: it follows the cloth. From a design,
// which has no markers, it runs along the design's normal to the point of the shape's grid.

#pragma once

#include <cmath>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/compare/shape_deviation.h"
#include "exporters/compare/shape_surfaces.h"
#include "exporters/design/mesh_distance.h"
#include "exporters/formats/surface_grid.h"
#include "importer/layout/layout.h"

namespace velamap {

struct Deflection {
  Eigen::Vector3d vector_m = Eigen::Vector3d::Zero();  // from the reference to the shape
  double distance_m = 0.0;                             // its component along the reference's normal
  // Sigma of the distance: from everything that the sigmas of the markers include (also the errors
  // that they share), from the alignment, and from the smoothing of the surfaces. Nothing if the
  // markers have none.
  std::optional<double> sigma_m;

  bool IsSignificant() const {
    return sigma_m && std::abs(distance_m) > kSignificantSigmas * *sigma_m;
  }
};

struct DeflectionField {
  std::string part;
  // On the reference, in its frame. Normals point to the side that the markers of the reference, or
  // the faces of the design, face.
  SurfaceGrid reference;
  // One per point of the grid; nothing if the shape is more than EdgeOptions::tolerance_mm
  // beyond the edge of the design.
  std::vector<std::optional<Deflection>> deflections;
};

struct DeflectionReport {
  std::vector<DeflectionField> fields;  // of the parts with lines, in the order of the layout
  std::vector<std::string> notes;       // parts without one, with the reason
};

// The surfaces of a shape in the frame of the reference, and the covariance of its corners in its
// own frame.
struct UncertainSurfaces {
  const ShapeSurfaces& surfaces;
  const PointCovariance& covariance;
};

// Computes how far the aligned shape is from the reference. `alignment` and `deviation` come from
// CompareWithShape() or CompareWithMesh(), and `shape` has the surfaces of
// ShapeDeviation::aligned_shape. An empty `part` means all parts. Only a design has an edge.
DeflectionReport ComputeDeflections(const Alignment& alignment, const UncertainSurfaces& shape,
                                    const UncertainSurfaces& reference, const Layout& layout,
                                    const GridOptions& grid, const std::string& part = "");
DeflectionReport ComputeDeflections(const ShapeDeviation& deviation, const UncertainSurfaces& shape,
                                    const MeshDistance& reference, const Layout& layout,
                                    const GridOptions& grid, const std::string& part = "",
                                    const EdgeOptions& edge = {});

// The fields of one compared shape, by name.
struct NamedDeflections {
  std::string shape;
  const DeflectionReport* report = nullptr;
};

// Header shape,part,section,point,u,v,x,y,z,dx,dy,dz,distance,sigma: sections from foot to head and
// points from luff to leech count from 1; m; unknown fields are empty.
void WriteDeflectionCsv(const std::vector<NamedDeflections>& shapes, std::ostream& out);

// The grid with the vectors `deflection` and the scalars `distance`, `is_known` (0 where there is
// no deflection, which is 0 then) and, if it is known everywhere, `sigma`; m.
void WriteDeflectionVts(const DeflectionField& field, const std::string& name, std::ostream& out);

}  // namespace velamap
