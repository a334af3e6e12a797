// Corners of markers that bend with a curved surface: where an image shows them, and where the fit
// of a flat pattern (importer/pattern/pattern_fit.h) finds them instead. That fit allows for a
// bend, but not for its middle being nearer to the camera, or farther away, than its ends.

#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "importer/bend/pattern_bend.h"
#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/problem/corner_errors.h"
#include "reconstruct/problem/marker_state.h"

namespace velamap {

// The error of the fit of a flat pattern, px, at the corners of a marker that bends with a surface
// of constant curvature. `curvature_1_m` is as in ChordSummary. Zero if a part of the marker is
// behind the camera.
QuadCorners CornerShiftsBySurface(const Camera& camera, const Rigid3& cam_from_marker,
                                  double length_m, const Eigen::Matrix2d& curvature_1_m);

// Moves the image points of the markers in `curvatures_1_m`, by marker id, including those in
// `removed`, to where a fit that models their bend would have found them. Points whose corner has
// no sigma in `errors` were not fitted and stay. All points of the model are corners.
void CorrectForBentMarkers(const std::map<int, Eigen::Matrix2d>& curvatures_1_m,
                           const MarkerState& state, const CornerErrors& errors,
                           const std::vector<RemovedObservation>& removed, Model* model);

}  // namespace velamap
