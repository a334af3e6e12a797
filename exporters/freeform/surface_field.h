// A smooth function of space whose zero set is the surface through points with sigmas. The surface
// may be open, closed, or have handles. The function approximates the signed distance from the
// surface, positive outside.
//
// The function is a Gaussian process: a quadratic polynomial plus the thin-plate covariance
//
//   k(r) = a^2 (2 r^3 - 3 D r^2 + D^3)
//
// (Williams and Fitzgibbon, "Gaussian process implicit surfaces", 2007), whose bending energy is
// the integral of the squared third derivatives in space. Planes, spheres, ellipsoids, cylinders,
// cones and saddles have no bending energy. Each point is an observation of the value 0 with its
// sigma, and each normal one of a slope of about 1, which fixes the sign and the unit of the
// function. The amplitude a maximizes the likelihood of the data (Rasmussen and Williams, Gaussian
// Processes for Machine Learning, 2006, sections 2.7 and 5.4). The sigma of the surface therefore
// covers both the noise of the points and how the surface may bend between them.

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

// The outward unit normal of the surface at a point near it.
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
  // A point without a sigma gets the median sigma of the others. If no point has one, all get the
  // sigma that maximizes the likelihood. Sigmas are at least 1e-5 of the largest distance of a
  // point from the mean of the points. The time grows with the third power of the number of points
  // and normals. Throws DataError if there is no point or no normal, and if all points coincide.
  SurfaceField(const std::vector<FieldPoint>& points, const std::vector<FieldNormal>& normals);

  FieldValue Evaluate(const Eigen::Vector3d& x_in_shape_m) const;

  // The standard deviation of the surface along its normal, m, at each of these points on it. Uses
  // up to `num_threads` threads (0: one per core).
  std::vector<double> Sigmas(const std::vector<Eigen::Vector3d>& points_in_shape_m,
                             int num_threads) const;

  // Moves a point along the gradient to the surface, by Newton steps. Returns nothing if they do
  // not converge or lead further away than `max_distance_m`.
  std::optional<Eigen::Vector3d> Project(const Eigen::Vector3d& x_in_shape_m,
                                         double max_distance_m) const;

  // The sigma that was used for point `idx`, m.
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
