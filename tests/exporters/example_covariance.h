// Uncertainties to export, with a dense twin to hold results against.

#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Of all corners of a model: points of a marker go together, and all points through three columns
// of the factor, one of them with a negative sign. Sigmas of about `sigma_m` to twice of it.
PointCovariance ExampleCovariance(const Model& model, double sigma_m, std::uint32_t seed);

AdjustmentUncertainty ExampleUncertainty(const Model& model);

// 3n x 3n.
Eigen::MatrixXd DenseCovariance(const PointCovariance& covariance);

// Draws shapes whose corners scatter as `covariance` says about those of `shape`, centres with
// them, and gives them to `visit`.
void SampleShapes(const MarkerShape& shape, const PointCovariance& covariance, int num_samples,
                  const std::function<void(const MarkerShape&)>& visit);

// Standard deviation of a figure over such shapes.
double SampledSigma(const MarkerShape& shape, const PointCovariance& covariance,
                    const std::function<double(const MarkerShape&)>& figure);

}  // namespace velamap
