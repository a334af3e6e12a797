// A shape against another one (two trims, two instants) or against a design's surface: how far each
// marker is from where the reference has it, and whether that is more than noise. All in the
// reference's frame.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/compare/mesh_distance.h"
#include "exporters/compare/shape_alignment.h"
#include "exporters/shape/marker_shape.h"
#include "importer/base/statistics.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// A difference of more sigmas than this is significant: by chance 1 of 22 is.
inline constexpr double kSignificantSigmas = 2.0;

struct UncertainShape {
  MarkerShape shape;
  PointCovariance covariance;  // of its corners, in its frame: the joint one, or
                               // CovarianceFromSigmas(); without a point no sigmas are reported
};

struct MarkerDeviation {
  int marker_id = 0;
  std::string part;
  Eigen::Vector3d x_in_reference_m = Eigen::Vector3d::Zero();  // of the aligned shape's centre
  // Of the reference's marker, or of the surface at the nearest point; unit.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance_m = 0.0;  // along the normal, positive where the shape is on its side
  std::optional<double> sigma_m;
  std::optional<double> significance;  // distance / sigma, with the sign of the distance
  // Shape against shape only: shape minus reference, of the centres.
  std::optional<Eigen::Vector3d> difference_m;
  std::optional<Eigen::Vector3d> difference_sigma_m;  // along the axes
  // Against a surface only: how far the marker lies beside it, see MeshFoot. Such a marker has no
  // distance that means anything and counts nowhere.
  double beside_m = 0.0;
  bool is_over_surface = true;
};

// Markers that belong together.
struct DeviationGroup {
  std::string part;
  std::string line;  // empty: the whole part
  Statistics distance_m;
  int num_significant = 0;
};

struct ShapeDeviation {
  Alignment alignment;
  MarkerShape aligned_shape;  // in the reference's frame, without sigmas
  // Against a shape: shape / reference, of the corners that it was aligned by (all common ones for
  // kNone). Never applied.
  std::optional<double> scale;
  std::vector<MarkerDeviation> markers;  // whole ones (in both), by id
  Statistics distance_m;                 // signed, of those that count
  Statistics difference_m;               // lengths of the vectors; against a shape
  int num_significant = 0;               // more than kSignificantSigmas
  int num_with_sigma = 0;
  int num_beside = 0;                 // beside the surface
  std::vector<DeviationGroup> parts;  // by name
  std::vector<DeviationGroup> lines;  // of the layout, in its order; those with a marker
  std::vector<int> only_in_shape;     // whole markers that the reference lacks
  std::vector<int> only_in_reference;
};

// Leaves only the markers of this part: as the layout has it, without a layout as the shape has it.
// Throws InputError, naming the parts there are, if none is left.
MarkerShape MarkersOnPart(const MarkerShape& shape, const Layout& layout, const std::string& part);

// Aligns all markers, then compares those of `part` (empty: all). Throws what AlignShapes() throws,
// and DataError when no whole marker is in both.
ShapeDeviation CompareWithShape(const UncertainShape& shape, const UncertainShape& reference,
                                const Layout& layout, const AlignmentOptions& options,
                                const std::string& part = "");

// Aligns and compares the markers of `part` only (empty: all). Throws what AlignToMesh() throws,
// and DataError when no whole marker lies over the surface.
ShapeDeviation CompareWithMesh(const UncertainShape& shape, const MeshDistance& mesh,
                               const Layout& layout, const AlignmentOptions& options,
                               const std::string& part = "");

// 1000 or 0.001 where the sizes of the two say that the mesh is read in the wrong unit of m and mm,
// the factor to apply to it; nothing where they are alike enough.
std::optional<double> UnitHint(const MarkerShape& shape, const MeshDistance& mesh);

}  // namespace velamap
