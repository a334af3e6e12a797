// A smooth surface through the horizontal lines of markers on a sail: a tensor-product B-spline
//
//   min over P   sum_k w_k |S(u_k, v_k) - x_k|^2
//                + a * integral of (|S_uuu|^2 + 3 |S_uuv|^2)
//                + b * integral of (3 |S_uvv|^2 + |S_vvv|^2)
//
// First each line is a curve of constant v and each marker on it has the u of its chord length from
// the luff (skinning; Piegl and Tiller, The NURBS Book, 1997, section 10.3). The markers then move
// to their feet on the surface (Hoschek, "Intrinsic parametrization for approximation", 1988), so
// that only distances along the normal are left: of parabolas first, of the surface afterwards. All
// markers are solved in one system and bend the surface alike, on a line or between lines. A
// penalty on third derivatives costs nothing for parabolas; the usual one on second derivatives
// flattens the camber at luff and leech.
//
// The four corners of a marker give three observations x_k: their mean, and half the vectors
// between the middles of opposite sides, which show how the cloth is tilted there. Tilts say most
// about the surface between the lines. How noisy they are compared with the means follows from the
// residuals.
//
// Generalized cross-validation decides on the weights a and b (Golub, Heath and Wahba, 1979);
// sigmas weigh the markers against each other, and markers without one get the median. Fewer than
// 30 markers with sigmas get the weights that minimize the expected error of the distances along
// the normal (Mallows, "Some comments on Cp", 1973); without sigmas, all get a small nominal one.
// A sigma of 0 means that all markers are interpolated.

#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "exporters/formats/surface_spline.h"
#include "exporters/surface/surface_input.h"
#include "importer/base/ids.h"
#include "importer/base/option.h"
#include "importer/base/statistics.h"

namespace velamap {

struct SurfaceOptions {
  // How far the surface continues beyond the outer markers, with the curvature it has there: at
  // most the length of the lines (luff, leech) or the distance from the lowest to the highest line
  // (foot, head). Without it, the surface ends where the input says that the cloth does, or else at
  // the outer markers.
  std::optional<double> luff_extension_mm, leech_extension_mm;
  std::optional<double> foot_extension_mm, head_extension_mm;
  // Edges to which the surface continues instead.
  SurfaceEdges edges;

  // Throws InputError that names the option for a value beyond its range and an edge that is both
  // given and extended; also for an edge of one point.
  void Check() const;
};

OptionGroup DescribeOptions(SurfaceOptions* options);

struct SurfaceResidual {
  int marker_id = 0;
  std::string line;         // empty for a marker on no line of the fit
  double u = 0.0, v = 0.0;  // of the marker's foot on the surface
  // Mean distance from the surface to the corners of the marker, along the normal.
  double distance_m = 0.0;
  double beyond_edge_m = 0.0;  // how far the marker lies outside the surface's edge
  bool is_used = false;        // false for markers outside the edge, which the fit ignores
  // From the mean of the corners to the cloth in the middle of a used marker, along the normal. Not
  // 0 where the cloth bends, and free of the marker's distance from the surface.
  double bend_m = 0.0;
};

struct SurfaceEdgePoint {
  std::string edge;  // luff, leech, foot or head
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();
  // Sigma along the normal. It grows with the distance from the markers. Nothing if the markers are
  // interpolated, because nothing is known about their noise then.
  std::optional<double> sigma_m;
};

struct FittedSurface {
  SplineSurface surface;
  std::vector<SurfaceResidual> residuals;  // of every marker centre of the part, by marker id
  Statistics distance_m;                   // signed, of the used markers
  // Trace of the hat matrix. A value near the number of used markers means interpolation.
  double num_effective_parameters = 0.0;
  // Per coordinate of the poles (surface_smoother.h); empty if the markers are interpolated.
  Eigen::MatrixXd pole_covariance_m2;
  // The same covariance in two parts, for noise that the markers share. `points` are the corners of
  // the markers of the fit (corner 0: a marker without corners). The first matrix holds what each
  // of them adds to the poles (poles x points, rows sum to 1), the second what the smoothing alone
  // adds.
  std::vector<CornerId> points;
  Eigen::MatrixXd pole_by_point, smoothing_covariance_m2;
  std::vector<SurfaceEdgePoint> edges;  // luff and leech from foot, foot and head from luff
  std::vector<std::string> notes;       // lines left out and why, gaps, markers outside the edge
};

// Sigma of the surface at a place along its normal, m; nothing if the markers are interpolated.
// The noise counts as independent from marker to marker.
std::optional<double> SigmaAt(const FittedSurface& fit, double u, double v);

// How the surface at a place depends on the markers of the fit.
struct SurfaceDependence {
  Eigen::VectorXd point_weights;  // by FittedSurface::points; they sum to 1
  // The two parts of the square of SigmaAt(): from the noise of the markers as the residuals show
  // it, independent from marker to marker, and from what the smoothing may have flattened.
  double noise_variance_m2 = 0.0, smoothing_variance_m2 = 0.0;

  // Variance of the surface if the noise of its markers, which they may share, contributes
  // `by_markers_m2`; the residuals count instead if they show more noise.
  double VarianceWith(double by_markers_m2) const {
    return std::max(by_markers_m2, noise_variance_m2) + smoothing_variance_m2;
  }
};
// Returns nothing if the markers are interpolated.
std::optional<SurfaceDependence> DependenceAt(const FittedSurface& fit, double u, double v);

// Whether the surface's normals point to the side that most of the markers face. `shape` holds the
// markers of the fit.
bool FacesLikeMarkers(const FittedSurface& fit, const MarkerShape& shape);

// Throws InputError for bad options and for an extension beyond its limit. Throws DataError if the
// markers do not determine a surface: fewer than two lines with three whole markers, two markers in
// one place, lines that cross or run in opposite directions, or a surface that oscillates between
// its markers.
FittedSurface FitSurface(const SurfaceInput& input, const SurfaceOptions& options = {});

}  // namespace velamap
