// The estimation of the image formation as a problem of MinimizeSquares().

#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "importer/formation/formation_state.h"
#include "importer/geometry/least_squares.h"

namespace velamap {

// Prior knowledge of usual cameras, and of what printers do to the edge of a dark area: means, 1
// sigma, and limits.
struct FormationPriors {
  FormationVector mean, sigma, min, max;
  double side_mm = 0.0;  // as in FormationState
};

// The prior of the ink's spread is a length on paper; the median side of the samples converts it
// into a fraction of the side. `samples` must not be empty.
FormationPriors PriorsFor(const std::vector<FormationSample>& samples);

// Residuals are divided by the noise of their sample, so samples that the model does not describe,
// whose fits jump between minima, have hardly any influence.
class FormationProblem : public LeastSquaresProblem<kNumFormationParameters> {
 public:
  using Parameters = FormationState;

  // `noises`: grey levels; infinite for samples that do not count. The priors must outlive this.
  FormationProblem(const FormationPriors& priors, std::vector<double> noises,
                   const FitWorkers& workers);

  // Derivatives take eight fits of every sample. They are not computed where the cost is higher
  // than before, because such a step is rejected.
  void Evaluate(const FormationState& state, bool, Equations* equations) const;

  FormationState Plus(const FormationState& state, const Step& step) const;

  double Cost(const FormationState& state) const;

  // The part of FormationEstimate::inset_sigma_px that the parameters cause, at their minimum. The
  // residuals of a sample share errors that no parameter describes, so the covariance is the
  // sandwich estimate over the samples (Huber 1967, White 1980). It is never smaller than for
  // independent residuals, because few samples may agree by chance.
  double InsetSigma(const FormationState& state) const;

 private:
  // Influence of each sample on the mean inset.
  std::vector<double> InfluencesOf(const FormationState& state,
                                   const FormationVector& by_inset) const;

  Equations SumUp(const FormationState& state, bool with_derivatives) const;

  void AddSample(const FormationState& state, bool with_derivatives, std::size_t i,
                 Equations* equations) const;

  FormationVector PriorWeight() const;

  const FormationPriors& priors_;
  std::vector<double> noises_;  // of the samples
  const FitWorkers& workers_;
  CauchyLoss loss_{9.0};
  mutable double least_cost_ = std::numeric_limits<double>::infinity();
};

}  // namespace velamap
