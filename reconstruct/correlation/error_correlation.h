// Errors that several corners have in common. Neighbouring frames of a video share pixel phases and
// blur, the corners of one image share errors of its pose and of the lens. Such errors move the
// result farther than independent errors of the corners would.

#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include "reconstruct/problem/marker_problem.h"
#include "reconstruct/problem/normal_equations.h"

namespace velamap {

// Few enough that errors that last for a tenth of a video still fall into one group.
constexpr int kNumCorrelationGroups = 5;

// Divides the images, in the natural order of their names, into up to `max_num_groups` groups of
// about equal size, so that neighbours in time share a group. Returns the group, 0, 1, ..., of each
// image.
std::vector<int> GroupImages(const Model& model, int max_num_groups);

// The factor, 1 or more, by which the corners' sigmas have to grow to account for common errors. It
// is the root of the ratio of two squared movements of the shape (after alignment with scale): the
// movement that the residuals of each group cause, and the movement that independent errors with
// the same weights would cause. The latter are simulated and pass through the same linearized
// adjustment, so that no share of the parameters has to be assumed for a group. 1 if the excess is
// within two sigmas of chance. Errors that all groups share cause no residuals and are not
// detected. `problem` belongs to `state` at its solution, without loss and with calibrated sigmas.
double CorrelationFactor(const MarkerState& state, const MarkerProblem& problem,
                         const MarkerJacobian& jacobian, const MarkerCovariance& covariance,
                         const std::vector<int>& groups, int num_threads);

// The same for linear functions of the points, such as the sizes of the markers: `by_points` has a
// row for each function and a column for each coordinate, in the order of the parameters.
double CorrelationFactorOf(const Eigen::SparseMatrix<double>& by_points, const MarkerState& state,
                           const MarkerProblem& problem, const MarkerJacobian& jacobian,
                           const MarkerCovariance& covariance, const std::vector<int>& groups,
                           int num_threads);

// The factor, 1 or more, by which the sigma of the global parameter in `column` has to grow. It is
// found like CorrelationFactor(), from movements of this parameter instead of the shape, but
// without the test for chance: with the few groups of one parameter, that test would hide factors
// of up to 1.5. It contains whatever the residuals of a group have in common, such as a motion of
// the markers that no parameter describes.
double GlobalCorrelationFactor(const MarkerState& state, const MarkerProblem& problem,
                               const MarkerJacobian& jacobian, const MarkerCovariance& covariance,
                               const std::vector<int>& groups, int column, int num_threads);

// 1 sigma of the global parameter in `column` due to errors that the corners of an image share.
// `errors` has two rows for each entry of problem.corners, in sigmas of the corners. Each column is
// 1 sigma of one kind of error, which is independent from image to image.
double SigmaByImageErrors(const MarkerProblem& problem, const MarkerJacobian& jacobian,
                          const MarkerCovariance& covariance, int column,
                          const RowMajorMatrix& errors);

}  // namespace velamap
