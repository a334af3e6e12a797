// A smooth surface through the horizontal lines of markers on a sail: a tensor-product B-spline
//
//   min over P   sum_k w_k |S(u_k, v_k) - x_k|^2  +  lambda * integral of |third derivatives of
//   S|^2
//
// Each line is a curve of constant v, each marker on it has the u of its chord length from the
// luff, so for a small lambda this is the skinning of the lines' smoothing splines (Piegl and
// Tiller, The NURBS Book, 1997, section 10.3). One system for all lines rather than one spline a
// line: lines need not have the same number of markers, gaps are bridged in the sense of the
// neighbours, and markers between the lines take part at their feet on the surface. The third
// derivative leaves parabolas alone, so that the camber is not pulled flat at luff and leech as a
// natural spline does.
//
// lambda: where the markers have sigmas it minimises the expected error (Mallows' Cp of the
// distances along the normal; Mallows, "Some comments on Cp", 1973), but is not smaller than what
// generalised cross-validation finds (Golub, Heath and Wahba, 1979), which it is without sigmas; a
// sigma of 0 interpolates.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/formats/surface_spline.h"
#include "exporters/sail/surface_input.h"
#include "importer/base/option.h"
#include "importer/base/statistics.h"

namespace velamap {

struct SurfaceOptions {
  // 1 sigma of markers without one of their own. Nothing: the median of the others; where no marker
  // has one, cross-validation finds the noise (with 30 markers or more; fewer are interpolated).
  // 0: the surface passes through all markers.
  std::optional<double> default_sigma_m;
  // How far the surface goes on beyond the outer markers, with the curvature that it has there.
  double luff_extension_m = 0.0;
  double leech_extension_m = 0.0;
  double foot_extension_m = 0.0;
  double head_extension_m = 0.0;
  // Edges that it goes on to instead.
  SurfaceEdges edges;

  // Throws InputError that names the option: a value beyond its range, a negative sigma, an edge of
  // one point, an edge that is both given and extended.
  void Check() const;
};

OptionGroup DescribeOptions(SurfaceOptions* options);

struct SurfaceResidual {
  int marker_id = 0;
  std::string line;            // "" for a marker on no horizontal line that was used
  double u = 0.0, v = 0.0;     // of its foot
  double distance_m = 0.0;     // of the marker's centre from the surface, along its normal
  double beyond_edge_m = 0.0;  // how far it lies beside the surface
  bool is_used = false;        // false: beside the surface, so it took no part in the fit
};

struct FittedSurface {
  SplineSurface surface;
  std::vector<SurfaceResidual> residuals;  // of every marker centre of the part, by marker id
  Statistics distance_m;                   // of the used ones, with their sign
  double num_effective_parameters = 0.0;   // trace of the hat matrix; close to the number of used
                                           // points: it interpolates
  std::vector<std::string> notes;          // lines left out and why, gaps, markers beside it
};

// Throws InputError for bad options and DataError where the data bear no surface: fewer than two
// lines with three whole markers, two markers in one place, lines that cross or run against each
// other, or a surface that swings between its markers.
FittedSurface FitSurface(const SurfaceInput& input, const SurfaceOptions& options = {});

}  // namespace velamap
