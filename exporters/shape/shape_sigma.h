// What the joint covariance of the corners says of lengths and areas: their gradients by the
// corners, and the standard deviation of any function with a gradient.

#pragma once

#include <optional>

#include "exporters/shape/marker_shape.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Adds `weight` . x of a corner (1..4) or of the centre (0), the mean of the corners.
void AddPointGradient(int marker_id, int corner, const Eigen::Vector3d& weight,
                      PointGradient* gradient);

// Of the distance between two points of the shape (corner 0: the centre), which have to be there. A
// distance of zero has no direction and gets an empty gradient.
PointGradient DistanceGradient(const ShapeMarker& marker1, int corner1, const ShapeMarker& marker2,
                               int corner2);

// Of the side from corner `side` to the next one (1..4). Needs a whole marker.
PointGradient SideGradient(const ShapeMarker& marker, int side);

// Of the mean of the four sides. Needs a whole marker.
PointGradient MeanSideGradient(const ShapeMarker& marker);

// Of MarkerArea(), m. Needs a whole marker.
PointGradient AreaGradient(const ShapeMarker& marker);

// 1 sigma of the function with this gradient, in its unit; nothing without a covariance (null) and
// where it does not hold a point.
std::optional<double> SigmaOf(const PointCovariance* covariance, const PointGradient& gradient);

// Along x, y, z, m, of a corner or the centre.
std::optional<Eigen::Vector3d> PointSigma(const PointCovariance* covariance, int marker_id,
                                          int corner);

}  // namespace velamap
