// Standard deviations of lengths and areas from the joint covariance of the corners: gradients with
// respect to the corners, and the sigma of any function with such a gradient.

#pragma once

#include <map>
#include <optional>

#include "exporters/shape/marker_shape.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Adds the gradient of `weight` . x for a corner (1..4) or the centre (0), the mean of the corners.
void AddPointGradient(int marker_id, int corner, const Eigen::Vector3d& weight,
                      PointGradient* gradient);

// Returns the variance (m^2) of the independent errors of a marker's corners, from the mean
// variance of the corners and the variance of the centre. The model: all corners share the error of
// the centre, and each has an independent error less the mean of all four, so that these do not
// move the centre.
double OwnVarianceOfCorners(double mean_of_corners_m2, double of_center_m2);

// Gradient of the distance between two points of the shape (corner 0 is the centre), which have to
// be known. A distance of zero has no direction and gets an empty gradient.
PointGradient DistanceGradient(const ShapeMarker& marker1, int corner1, const ShapeMarker& marker2,
                               int corner2);

// Gradient of the side from corner `side` (1..4) to the next one. The marker must be whole.
PointGradient SideGradient(const ShapeMarker& marker, int side);

// Gradient of the mean of the four sides. The marker must be whole.
PointGradient MeanSideGradient(const ShapeMarker& marker);

// Gradient of MarkerArea(), m. The marker must be whole.
PointGradient AreaGradient(const ShapeMarker& marker);

// Whether the covariance is given (not null) and has all points of the gradient.
bool HasPointsOf(const PointGradient& gradient, const PointCovariance* covariance);

// 1 sigma of the function with this gradient, in its unit. Returns nothing without a covariance
// (null), with one that lacks a point, and for an empty gradient.
std::optional<double> SigmaOf(const PointCovariance* covariance, const PointGradient& gradient);

// 1 sigma of a corner or the centre along x, y and z, m.
std::optional<Eigen::Vector3d> PointSigma(const PointCovariance* covariance, int marker_id,
                                          int corner);

// 1 sigma, m, that is assumed for each coordinate of the points if none is known: 0.1 mm on a sail
// of 3 m. It keeps a curve or a surface from swinging between few points, and hides no shape that
// markers show. Ten times more or less hardly changes the fit.
double NominalSigma(const Eigen::Matrix3Xd& points_in_shape_m);

// The covariance without the errors that markers share, such as the scale; nothing for null.
std::optional<PointCovariance> WithoutSharedErrors(const PointCovariance* covariance);

// 1 sigma in space, the root of the trace of the covariance, of the centre of each marker whose
// four corners are known, mm; by marker id.
std::map<int, double> CenterSigmas_mm(const PointCovariance& covariance);

// The median over the markers. There must be at least one.
double MedianSigma(const std::map<int, double>& sigma_by_marker);

}  // namespace velamap
