// Moves a result into another frame.

#pragma once

#include <Eigen/Geometry>

#include "exporters/shape/marker_shape.h"
#include "importer/geometry/rigid3.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Rotates the covariance into the frame; a translation does not change it. It stays relative to the
// datum of the adjustment: the uncertainty of the frame itself is not added.
PointCovariance RotateCovariance(const Eigen::Quaterniond& frame_from_shape,
                                 const PointCovariance& covariance);

// Moves the shape into the frame. The sigmas along the new axes come from `covariance_in_frame`.
// Without it (null), or if it lacks a point, a rotation keeps only sigmas that are equal along all
// axes and drops the others.
void MoveShape(const Rigid3& frame_from_shape, const PointCovariance* covariance_in_frame,
               MarkerShape* shape);

}  // namespace velamap
