// Uncertainties to export, with a dense covariance for comparison.

#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"

namespace velamap {

// A covariance of all corners of a model that correlates the points of a marker, and all points by
// three columns of the factor, one of them negative. Sigmas are about `sigma_m` to twice of it.
PointCovariance ExampleCovariance(const Model& model, double sigma_m, std::uint32_t seed);

AdjustmentUncertainty ExampleUncertainty(const Model& model);

// 3n x 3n.
Eigen::MatrixXd DenseCovariance(const PointCovariance& covariance);

// Samples shapes whose corners scatter about those of `shape` with `covariance`, computes their
// centres, and passes them to `visit`.
void SampleShapes(const MarkerShape& shape, const PointCovariance& covariance, int num_samples,
                  const std::function<void(const MarkerShape&)>& visit);

// Standard deviation of a figure over such samples.
double SampledSigma(const MarkerShape& shape, const PointCovariance& covariance,
                    const std::function<double(const MarkerShape&)>& figure);

}  // namespace velamap
