// Cost functions of the prior knowledge in the marker-aware bundle adjustment: printed markers,
// measured distances, cameras. Residuals are divided by their sigmas; derivatives are analytic.
// marker_cost_functions.h lists the parameter blocks.

#pragma once

#include <utility>
#include <vector>

#include <ceres/cost_function.h>

#include "reconstruct/problem/marker_chords.h"

namespace velamap {

// Prior of the shape of a printed marker. A sigma that is not positive switches its part off.
struct MarkerPrior {
  double length_m = 0.0;           // of a side
  double side_sigma_m = 0.0;       // of a side
  double diagonals_sigma_m = 0.0;  // of the difference of the diagonals
  double flatness_sigma_m = 0.0;   // of a corner's distance from the plane of the marker
  MarkerChords chords{};
};

// Residuals of a marker, divided by 1 + print scale + part scale, against its prior: sides between
// neighbouring corners minus the length of their chord; for a marker with four corners also the
// difference of the diagonals, minus its expectation, and the distance h of the corners from their
// best plane (h, -h, h, -h for corners 1 to 4). Without the diagonals a square could become a
// rhombus, which a single view cannot tell from a tilted square. If the scale multiplied the length
// instead, a smaller model would have smaller residuals, and scales that are free would shrink it.
// `corners` are 1..4, ascending. Blocks: marker, print scale, part scale.
class MarkerPriorError : public ceres::CostFunction {
 public:
  MarkerPriorError(const MarkerPrior& prior, const std::vector<int>& corners);

  // Pairs of slots of neighbouring corners.
  static std::vector<std::pair<int, int>> Sides(const std::vector<int>& corners);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  MarkerPrior prior_;
  std::vector<std::pair<int, int>> sides_;
  std::vector<double> chords_m_;  // by `sides_`
  bool has_diagonals_ = false;
  bool has_flatness_ = false;
};

// Known distance between two points, each of which is a corner or the mean of a marker's corners:
// (|sum of weight * corner| - length) / sigma. There is one block for each marker, with the weights
// of its corners; those of the first point are negative.
class ScaleBarError : public ceres::CostFunction {
 public:
  ScaleBarError(double length_m, double sigma_m, std::vector<std::vector<double>> corner_weights);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  double length_m_, sigma_m_;
  std::vector<std::vector<double>> corner_weights_;
};

// (parameter - mean) / sigma for each parameter of one block. An infinite sigma adds nothing.
class ParameterPriorError : public ceres::CostFunction {
 public:
  ParameterPriorError(std::vector<double> mean, std::vector<double> sigma);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  std::vector<double> mean_, sigma_;
};

// log(fx / fy) / sigma of a camera with two focal lengths, which come first of its `num_params`.
class PixelShapeError : public ceres::CostFunction {
 public:
  PixelShapeError(int num_params, double sigma);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  double sigma_;
};

}  // namespace velamap
