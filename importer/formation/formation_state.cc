#include "importer/formation/formation_state.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "importer/base/parallel.h"
#include "importer/base/statistics.h"

namespace velamap {
namespace {

void AddResiduals(const FittedSample& sample, bool at_outline_corners,
                  std::vector<double>* residuals) {
  for (std::size_t j = 0; j < sample.residuals.size(); ++j) {
    if (sample.places[j].is_at_outline_corner == at_outline_corners &&
        !IsClipped(sample, sample.places[j])) {
      residuals->push_back(sample.residuals[j]);
    }
  }
}

double NoiseOf(const std::vector<double>& residuals) {
  constexpr double kMinNoise = 0.5;  // 8 bits round
  return residuals.empty() ? std::numeric_limits<double>::infinity()
                           : std::max(kMinNoise, RobustSigma(residuals));
}

double NoiseOf(const FormationState& state, bool at_outline_corners) {
  std::vector<double> residuals;
  for (const FittedSample& sample : state.samples) {
    AddResiduals(sample, at_outline_corners, &residuals);
  }
  return NoiseOf(residuals);
}

void FitAll(std::size_t count, const FitWorkers& workers,
            const std::function<void(std::size_t)>& fit) {
  ParallelFor(count, workers.num_threads, [&](std::size_t i) {
    fit(i);
    if (workers.on_fit) workers.on_fit();
  });
}

// `formation` with the parameters of the vector.
ImageFormationParameters With(const FormationVector& p, double side_mm,
                              ImageFormationParameters formation) {
  formation.gamma = std::exp(p[kLogGamma]);
  formation.s_amplitude = p[kSAmplitude];
  formation.sharpening = p[kSharpening];
  formation.sharpening_radius_px = std::exp(p[kLogRadius]);
  formation.ink_spread_mm = p[kInkSpread] * side_mm;
  formation.edge_shift_blurs = p[kEdgeShift];
  formation.halo = p[kHalo];
  formation.halo_radius_px = std::exp(p[kLogHaloRadius]);
  return formation;
}

}  // namespace

FormationState FitSamples(const std::vector<FormationSample>& samples, const FormationVector& start,
                          double side_mm, const ImageFormationParameters& formation,
                          const FitWorkers& workers) {
  FormationState state;
  state.parameters = start;
  state.side_mm = side_mm;
  state.formation =
      std::make_shared<const ImageFormation>(With(state.parameters, side_mm, formation));
  std::vector<std::optional<FittedSample>> fitted(samples.size());
  FitAll(samples.size(), workers, [&](std::size_t i) {
    fitted[i] = FitSample(samples[i], *state.formation);
    if (fitted[i]) RefitSample(*state.formation, state.formation->tone(), &*fitted[i]);
  });
  for (std::optional<FittedSample>& sample : fitted) {
    if (sample) state.samples.push_back(std::move(*sample));
  }
  return state;
}

FormationState FittedWith(const ImageFormationParameters& formation,
                          const FormationVector& parameters, const FormationState& state,
                          const FitWorkers& workers) {
  FormationState moved{parameters, state.side_mm, std::make_shared<const ImageFormation>(formation),
                       state.samples, nullptr};
  FitAll(moved.samples.size(), workers, [&](std::size_t i) {
    RefitSample(*moved.formation, state.formation->tone(), &moved.samples[i]);
  });
  return moved;
}

FormationState MovedTo(const FormationVector& parameters, const FormationState& state,
                       const FitWorkers& workers) {
  return FittedWith(With(parameters, state.side_mm, state.formation->parameters()), parameters,
                    state, workers);
}

std::vector<double> QuietZones(const FormationState& state) {
  std::vector<double> widths;
  for (const FittedSample& sample : state.samples) {
    const auto& margins = sample.minimum.parameters.segment<4>(PatternParameters::kMargin);
    widths.insert(widths.end(), margins.begin(), margins.end());
  }
  return widths;
}

FormationState WithPooledQuietZone(FormationState state, const FitWorkers& workers) {
  constexpr int kMaxIterations = 5;
  constexpr double kTolerance = 0.01;  // cells
  for (int i = 0; i < kMaxIterations; ++i) {
    ImageFormationParameters formation = state.formation->parameters();
    const double before = formation.quiet_zone_cells;
    formation.quiet_zone_cells = Median(QuietZones(state));
    if (std::abs(formation.quiet_zone_cells - before) < kTolerance) break;
    state = FittedWith(formation, state.parameters, state, workers);
  }
  return state;
}

double NoiseOf(const FormationState& state) { return NoiseOf(state, false); }

std::vector<double> NoisesOf(const FormationState& state) {
  std::vector<double> noises;
  for (const FittedSample& sample : state.samples) {
    std::vector<double> residuals;
    AddResiduals(sample, false, &residuals);
    noises.push_back(NoiseOf(residuals));
  }
  return noises;
}

double OutlineCornerWeight(const FormationState& state) {
  const double relative_noise = NoiseOf(state, true) / NoiseOf(state, false);
  return 1 / std::max(1.0, relative_noise * relative_noise);
}

FormationState WithOutlineCorners(double weight, const FormationState& state,
                                  const FitWorkers& workers) {
  ImageFormationParameters formation = state.formation->parameters();
  formation.outline_corner_weight = weight;
  return FittedWith(formation, state.parameters, state, workers);
}

bool AreAlike(const FittedSample& one, const FittedSample& other) {
  constexpr double kMaxShiftPx = 0.25;
  return !one.residuals.empty() && !other.residuals.empty() &&
         MaxCornerShift(CornersOf(one.minimum.parameters), CornersOf(other.minimum.parameters)) <=
             kMaxShiftPx;
}

double MeanInset(const FormationState& one, const FormationState& other) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < one.samples.size(); ++i) {
    const FittedSample &a = one.samples[i], &b = other.samples[i];
    if (!AreAlike(a, b)) continue;
    sum += 0.5 * (QuadMeanSide(CornersOf(b.minimum.parameters)) -
                  QuadMeanSide(CornersOf(a.minimum.parameters)));
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

}  // namespace velamap
