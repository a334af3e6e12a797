// A smooth function whose zero set is the surface that points with sigmas lie on, whatever its
// shape: open, closed, or with handles. It is near the signed distance, positive outside.
//
// The function is a Gaussian process: a quadratic polynomial plus the thin-plate covariance
//
//   k(r) = a^2 (2 r^3 - 3 D r^2 + D^3)
//
// (Williams and Fitzgibbon, "Gaussian process implicit surfaces", 2007), whose bending energy is
// the integral of the squared third derivatives in space. Planes, spheres, ellipsoids, cylinders,
// cones and saddles cost nothing. The points give values of 0 with their sigmas, and the normals
// give a slope of about 1, which fixes sign and unit. The amplitude a maximizes the likelihood of
// the data (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sections 2.7
// and 5.4), so that the sigma of the result contains both the noise of the points and what the
// surface may do between them.

#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "exporters/freeform/field_regression.h"

namespace velamap {

// A point on the surface.
struct FieldPoint {
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();
  std::optional<double> sigma_m;  // along the normal
};

// The outward unit normal at a place near the surface.
struct FieldNormal {
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

struct FieldValue {
  double value_m = 0.0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

class SurfaceField {
 public:
  // A point without a sigma gets the median of the others; if none has one, all get the sigma that
  // maximizes the likelihood. Sigmas below 1e-5 of the extent are raised to it. Time grows with the
  // third power of the number of points. Throws DataError without a point or a normal, and for
  // points that are all in one place.
  SurfaceField(const std::vector<FieldPoint>& points, const std::vector<FieldNormal>& normals);

  FieldValue Evaluate(const Eigen::Vector3d& x_in_shape_m) const;

  // One standard deviation of the surface along its normal at each of these points on it, m, with
  // up to `num_threads` threads (0: one per core).
  std::vector<double> Sigmas(const std::vector<Eigen::Vector3d>& points_in_shape_m,
                             int num_threads) const;

  // Where the line of steepest slope from this point meets the surface; nothing if it ends before,
  // or further away than `max_distance_m`.
  std::optional<Eigen::Vector3d> Project(const Eigen::Vector3d& x_in_shape_m,
                                         double max_distance_m) const;

  // The sigma by which point `idx` was weighted, m.
  double PointSigma(std::size_t idx) const {
    return sigmas_(static_cast<Eigen::Index>(idx)) * scale_m_;
  }

 private:
  Eigen::Vector3d Normalized(const Eigen::Vector3d& x_in_shape_m) const {
    return (x_in_shape_m - center_m_) / scale_m_;
  }

  Eigen::Vector3d center_m_ = Eigen::Vector3d::Zero();
  double scale_m_ = 1.0;  // the unit of normalized coordinates
  FieldRows rows_;        // points, then normals
  Eigen::VectorXd sigmas_;
  double amplitude_ = 1.0;
  FieldSolution solution_;
};

}  // namespace velamap
