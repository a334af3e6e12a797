#include "importer/refine/edge_fit.h"

#include <gtest/gtest.h>

#include "tests/importer/lane_derivatives.h"

namespace velamap {
namespace {

TEST(EvaluateEdge, DerivativesAgreeWithDifferences) {
  EdgeParameters parameters;
  parameters.values << 0.2, -0.1, 0.15, 0.9, 40, 180, 5, -7, 0.8, 1.1;
  const EdgeSampleGroup samples{
      AllLanes(0.4), Floats{-2.1f, -0.4f, 0.3f, 1.7f, -1.2f, 0.0f, 0.8f, 2.3f},
      AllLanes(100), AllLanes(0.9),
      AllLanes(120), AllLanes(-110),
      AllLanes(2.2), AllLanes(2.4)};
  EdgeEquations::Jacobian jacobian;
  EvaluateEdge(parameters, samples, &jacobian);
  const auto value = [&](const EdgeParameters::Vector& values) {
    EdgeEquations::Jacobian unused;
    return EvaluateEdge(EdgeParameters{values}, samples, &unused);
  };
  ExpectDerivatives<EdgeParameters::Vector>(
      parameters.values, EdgeParameters::Vector::Constant(0.01), jacobian, value, 0.002, 0.05);
}

}  // namespace
}  // namespace velamap
