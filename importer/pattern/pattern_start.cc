#include "importer/pattern/pattern_start.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "importer/detect/cell_means.h"
#include "importer/detect/gray_levels.h"
#include "importer/geometry/unit_square_map.h"

namespace velamap {
namespace {

using P = PatternParameters;

// Usual for cloth; the label of a can has ten times as much.
constexpr double kBendOfDiagonal = 0.003;

double LightAt(const PatternProblem& problem, const UnitSquareMap& map, double u, double v) {
  return LightAt(problem.patch, *problem.model.formation, map.ToImage(u, v));
}

// Widths of the quiet zone in cells, ordered as in PatternParameters: the place on the way outwards
// from a side where the light is halfway between `light`, the light cells of the marker, and what
// lies beyond. 1 where both are alike.
Eigen::Vector4d FindMargins(const PatternProblem& problem, const UnitSquareMap& map, double dark,
                            double light) {
  constexpr int kPlaces = 9, kSteps = 18;
  constexpr double kStep = 0.1;   // cells
  constexpr double kAlike = 0.1;  // difference relative to the contrast
  const int n = problem.model.num_cells;
  Eigen::Vector4d margins = Eigen::Vector4d::Ones();
  for (int side = 0; side < 4; ++side) {
    std::array<double, kSteps> profile{};
    for (std::size_t k = 0; k < kSteps; ++k) {
      const double outwards = -(static_cast<double>(k) + 1) * kStep / n;
      const double across = side % 2 == 0 ? outwards : 1 - outwards;
      for (int i = 0; i < kPlaces; ++i) {
        const double along = (i + 0.5) / kPlaces;
        profile[k] += (side < 2 ? LightAt(problem, map, across, along)
                                : LightAt(problem, map, along, across)) /
                      kPlaces;
      }
    }
    const double beyond = (profile[kSteps - 1] + profile[kSteps - 2] + profile[kSteps - 3]) / 3;
    if (std::abs(beyond - light) < kAlike * std::abs(light - dark)) continue;
    const double middle = 0.5 * (beyond + light);
    std::size_t k = kSteps - 1;
    while (k > 0 && (profile[k] > middle) == (beyond > middle)) --k;
    margins[side] = std::clamp((static_cast<double>(k) + 1.5) * kStep, kMinMargin, kMaxMargin);
  }
  return margins;
}

// Mean light of the marker's dark and light cells, or of the quiet zone close to the marker where
// that is brighter: blur darkens cells, and the surroundings of a narrow quiet zone darken the
// zone.
struct CellLights {
  double dark = 0.0, light = 0.0;
};

CellLights ReadCellLights(const PatternProblem& problem, const UnitSquareMap& map) {
  constexpr double kBesideMarker = 0.5;  // cells
  const int n = problem.model.num_cells;
  const CellMeans means = MeansOfCells(problem.cells, [&](int column, int row) {
    return LightAt(problem, map, (column + 0.5) / n, (row + 0.5) / n);
  });
  double beside = 0;
  for (int j = 0; j < n; ++j) {
    const double along = (j + 0.5) / n, out = kBesideMarker / n;
    beside += LightAt(problem, map, along, -out) + LightAt(problem, map, along, 1 + out) +
              LightAt(problem, map, -out, along) + LightAt(problem, map, 1 + out, along);
  }
  beside /= 4 * n;
  const double light = means.light.value_or(beside);
  const ToneCurve& tone = problem.model.formation->tone();
  return {means.dark, tone.Encode(beside) > tone.Encode(light) ? beside : light};
}

}  // namespace

bool StartPatternFit(const QuadCorners& corners_px, const ImageFormationParameters& formation,
                     PatternProblem* problem, PatternMinimum* minimum) {
  const UnitSquareMap map(corners_px);
  const CellLights lights = ReadCellLights(*problem, map);
  const ToneCurve& tone = problem->model.formation->tone();
  if (!(tone.Encode(lights.light) - tone.Encode(lights.dark) > kMinContrast / 2)) return false;
  P::Vector& p = minimum->parameters;
  p.setZero();
  for (int i = 0; i < kNumCorners; ++i) {
    p.segment<2>(2 * i) = corners_px[static_cast<std::size_t>(i)];
  }
  p[P::kBlurU] = p[P::kBlurV] = p[P::kSurround] = p[P::kInnerLight] = 1.0;
  p[P::kDark] = lights.dark;
  p[P::kLight] = lights.light;
  problem->mean = p;
  // Smaller cells blur into each other, so one marker does not determine its margins.
  constexpr double kMinCellPx = 2.5;
  constexpr double kUnknownSigma = 0.25, kHeldSigma = 0.02;
  const bool shows_margins = QuadMeanSide(corners_px) >= kMinCellPx * problem->model.num_cells;
  constexpr double kUnheldSigma = 1e3;  // of the corners, px, and of dark and light
  constexpr double kBlurSigmaPx = 0.7, kGradientSigma = 0.15, kSurroundSigma = 0.3;
  // The light of the marker's cells and of the quiet zone differs little once the tone curve is
  // known. Before a dark background, a narrow quiet zone looks almost like a wider and dimmer one:
  // where its width is free, its light has to be known. In small cells the light also absorbs what
  // sharpening and compression do to them.
  constexpr double kKnownLightSigma = 0.005, kInnerLightSigma = 0.02;
  P::Vector sigma = P::Vector::Constant(kUnheldSigma);  // those of the margins follow
  sigma[P::kBlurU] = sigma[P::kBlurV] = kBlurSigmaPx;
  sigma[P::kGradientX] = sigma[P::kGradientY] = kGradientSigma;
  sigma[P::kSurround] = kSurroundSigma;
  sigma[P::kInnerLight] = shows_margins ? kKnownLightSigma : kInnerLightSigma;
  sigma.segment<4>(P::kBendU).setConstant(kBendOfDiagonal * problem->model.diagonal_px);
  problem->weight = (kPixelNoise * sigma.cwiseInverse()).cwiseAbs2();
  ImageFormationParameters quiet_zone = formation;
  if (formation.quiet_zone_sigma_cells == 0) {
    quiet_zone.quiet_zone_sigma_cells = shows_margins ? kUnknownSigma : kHeldSigma;
  }
  SetQuietZonePrior(quiet_zone, problem);
  p.segment<4>(P::kMargin) = shows_margins ? FindMargins(*problem, map, lights.dark, lights.light)
                                           : problem->mean.segment<4>(P::kMargin);
  return true;
}

}  // namespace velamap
