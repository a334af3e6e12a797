// Compares a shape with another one (two trims, two instants) or with the surface of a design: the
// distance of each marker from the reference, and its significance. Everything is in the frame of
// the reference.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/compare/shape_alignment.h"
#include "exporters/compare/shape_likeness.h"
#include "exporters/design/mesh_distance.h"
#include "exporters/shape/marker_shape.h"
#include "importer/base/statistics.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// A difference of more sigmas is significant; by chance, 1 of 22 differences is.
inline constexpr double kSignificantSigmas = 2.0;

struct UncertainShape {
  MarkerShape shape;
  // Covariance of the corners, in the frame of the shape: the joint one or CovarianceFromSigmas().
  // An empty covariance gives no sigmas.
  PointCovariance covariance;
};

struct MarkerDeviation {
  int marker_id = 0;
  std::string part;
  Eigen::Vector3d x_in_reference_m = Eigen::Vector3d::Zero();  // centre in the aligned shape
  // Unit normal of the reference's marker, or of the surface at the nearest point.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  // Along the normal, positive on its side. Of the centre from that of the reference's marker, or
  // of the marker from the surface, see ProjectMarker().
  double distance_m = 0.0;
  std::optional<double> sigma_m;
  std::optional<double> significance;  // distance / sigma, with the sign of the distance
  // Centre in the shape minus centre in the reference; only for two shapes.
  std::optional<Eigen::Vector3d> difference_m;
  std::optional<Eigen::Vector3d> difference_sigma_m;  // along the axes
  // Distance of the marker beyond the edge of the surface, see MeshFoot; only for a surface. Beyond
  // the reach of EdgeOptions, a marker is not over the surface: it has no meaningful distance and
  // is not part of any statistic.
  double beside_m = 0.0;
  bool is_over_surface = true;
};

// The markers of a part or a line.
struct DeviationGroup {
  std::string part;
  std::string line;  // empty for the whole part
  Statistics distance_m;
  int num_significant = 0;
};

struct ShapeDeviation {
  std::optional<ComparisonDoubt> doubt;  // whether the two can be compared at all
  Alignment alignment;
  // In the frame of the reference. The sigma of a point is the same along all axes, the root mean
  // square, which a rotation does not change.
  MarkerShape aligned_shape;
  // Scale of shape / reference from the corners of the alignment (all common ones for kNone); only
  // for two shapes, and never applied.
  std::optional<double> scale;
  std::vector<MarkerDeviation> markers;  // whole markers (of both shapes), by id
  Statistics distance_m;                 // signed, without markers beside the surface
  Statistics difference_m;               // lengths of the vectors; only for two shapes
  // Sigma of the surface along its normal, which the sigmas of the markers include; 0 if the
  // surface is exact or there is none.
  double surface_sigma_m = 0.0;
  int num_significant = 0;  // above kSignificantSigmas
  int num_with_sigma = 0;
  int num_beyond_edge = 0;            // beyond the edge of the surface, yet within reach
  int num_beside = 0;                 // beside the surface
  std::vector<DeviationGroup> parts;  // by name
  std::vector<DeviationGroup> lines;  // lines of the layout with a marker, in its order
  std::vector<int> only_in_shape;     // whole markers that the reference lacks
  std::vector<int> only_in_reference;
};

// The ids of the markers beside the surface.
std::vector<int> MarkersBeside(const ShapeDeviation& deviation);

// Selects the markers of a part, according to the layout or, without one, to the shape. Throws
// InputError with the existing parts if there are none.
MarkerShape MarkersOnPart(const MarkerShape& shape, const Layout& layout, const std::string& part);

// Aligns all markers and compares those of `part` (all markers if it is empty). Throws the errors
// of AlignShapes(), and DataError if the shapes have no whole marker in common.
ShapeDeviation CompareWithShape(const UncertainShape& shape, const UncertainShape& reference,
                                const Layout& layout, const AlignmentOptions& options,
                                const std::string& part = "");

// Aligns and compares only the markers of `part` (all markers if it is empty). A surface that was
// itself fitted to markers is known to `surface_sigma_m` along its normal; the one of a design is
// exact. Throws the errors of AlignToMesh(), and DataError if no whole marker lies over the
// surface.
ShapeDeviation CompareWithMesh(const UncertainShape& shape, const MeshDistance& mesh,
                               const Layout& layout, const AlignmentOptions& options,
                               const std::string& part = "", const EdgeOptions& edge = {},
                               double surface_sigma_m = 0.0);

// The factor, 1000 or 0.001, by which to multiply a mesh that was read in mm instead of m or the
// other way round. Returns nothing unless the diagonals of shape and mesh differ by a factor above
// 100.
std::optional<double> UnitHint(const MarkerShape& shape, const MeshDistance& mesh);

}  // namespace velamap
