// Least-squares alignment of two point sets in closed form.
//
// Umeyama, "Least-squares estimation of transformation parameters between two point patterns",
// IEEE TPAMI 13(4), 1991; without scale this is equation 3.1 of the thesis. Reflections are never
// returned.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "importer/geometry/rigid3.h"

namespace velamap {

// b_from_a that minimizes sum_i w_i |b_from_a * a_i - b_i|^2. Both lists have the same length, at
// least three; weights are non-negative, empty for all equal. Collinear points leave the rotation
// about their line undetermined: some minimizer is returned (see HasSpread()).
Rigid3 EstimateRigid3(const std::vector<Eigen::Vector3d>& x_in_a,
                      const std::vector<Eigen::Vector3d>& x_in_b,
                      const std::vector<double>& weights = {});

// The same over similarities, without weights.
Sim3 EstimateSim3(const std::vector<Eigen::Vector3d>& x_in_a,
                  const std::vector<Eigen::Vector3d>& x_in_b);

// Whether the points span a plane well enough to fix a rotation: the second principal standard
// deviation is at least a twentieth of the first.
bool HasSpread(const std::vector<Eigen::Vector3d>& points);

}  // namespace velamap
