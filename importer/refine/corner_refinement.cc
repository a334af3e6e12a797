#include "importer/refine/corner_refinement.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <opencv2/core.hpp>

#include "importer/base/error.h"
#include "importer/detect/gray_levels.h"
#include "importer/detect/marker_alignment.h"
#include "importer/detect/search_regions.h"
#include "importer/pattern/pattern_fit.h"
#include "importer/refine/edge_fit.h"
#include "importer/refine/edge_sampling.h"

namespace velamap {
namespace {

constexpr double kFirstBlurPx = 1.0;
// Half width of the band around a side.
constexpr double kBandInCells = 0.6, kMinBandPx = 1.5, kMaxBandPx = 6.0;

struct Pass {
  double band_px;
  int max_samples;  // of a side
  double tolerance_px;
  bool is_last;  // only the last pass estimates the uncertainty
};

struct FittedSide {
  Side side;
  EdgeParameters parameters;
  EdgeUncertainty uncertainty;
};

// Memory that the fits of a marker's sides share.
struct SideFitBuffers {
  EdgeSamples samples;
  EdgeFit fit;
};

std::optional<FittedSide> FitSide(const cv::Mat& gray, const SideModel& model, const Pass& pass,
                                  SideFitBuffers* buffers) {
  if (!(model.light - model.dark > kMinContrast)) return std::nullopt;
  SampleSide(gray, model, pass.band_px, pass.max_samples, &buffers->samples);
  const EdgePrior prior = MakeEdgePrior(model);
  EdgeFit& fit = buffers->fit;
  if (!FitEdge(buffers->samples, prior, pass.tolerance_px, &fit)) return std::nullopt;
  const EdgeParameters& p = fit.parameters;
  if (!(p.Contrast() > kMinContrast) || fit.equations.Rms() > kMaxRelativeRms * p.Contrast() ||
      std::abs(p[EdgeParameters::kOffset]) + std::abs(p[EdgeParameters::kSlope]) > pass.band_px) {
    return std::nullopt;
  }
  FittedSide fitted{model.side, p, {}};
  if (pass.is_last) {
    const auto uncertainty = EstimateUncertainty(fit, prior);
    if (!uncertainty) return std::nullopt;
    fitted.uncertainty = *uncertainty;
  }
  return fitted;
}

// The tangent of the fitted edge at its end s = -1 or 1, where the bend is zero.
ImageLine TangentAtEnd(const FittedSide& fitted, double s) {
  using E = EdgeParameters;
  const Side& side = fitted.side;
  const E& p = fitted.parameters;
  const double offset_px = p[E::kOffset] + p[E::kSlope] * s;
  const double slope = (p[E::kSlope] - 2 * p[E::kBend] * s) / side.half_length_px;
  return {side.middle_px + s * side.half_length_px * side.along + offset_px * side.outward,
          side.along + slope * side.outward};
}

// Variance of the place of the edge at its end, across the side, for noise of one grey level, px^2.
double VarianceAtEnd(const FittedSide& fitted, double s) {
  const Eigen::Vector2d by_place(1, s);
  return by_place.dot(fitted.uncertainty.place_covariance * by_place);
}

// Mean variance of the coordinates of the corner where `starting` begins and `ending` ends.
double CornerVariance(const FittedSide& starting, const FittedSide& ending) {
  Eigen::Matrix2d outwards;
  outwards << starting.side.outward.transpose(), ending.side.outward.transpose();
  const Eigen::Matrix2d by_places = outwards.inverse();
  return 0.5 * (by_places.col(0).squaredNorm() * VarianceAtEnd(starting, -1) +
                by_places.col(1).squaredNorm() * VarianceAtEnd(ending, 1));
}

struct Fit {
  RefinedCorners corners;
  double blur_px;
};

std::optional<Fit> FitSides(const cv::Mat& gray, const QuadCorners& corners_px, double blur_px,
                            int num_cells, const Pass& pass, SideFitBuffers* buffers) {
  std::array<FittedSide, kNumCorners> sides;
  ResidualNoise noise;
  Fit fit{{}, 0.0};
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const SideModel model =
        MakeSideModel(gray, corners_px, static_cast<int>(i), num_cells, blur_px);
    const auto side = FitSide(gray, model, pass, buffers);
    if (!side) return std::nullopt;
    sides[i] = *side;
    noise.Add(side->uncertainty.noise);
    fit.blur_px += side->parameters[EdgeParameters::kBlur] / kNumCorners;
  }
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const FittedSide& ending = sides[(i + kNumCorners - 1) % kNumCorners];
    const auto corner = Intersect(TangentAtEnd(sides[i], -1), TangentAtEnd(ending, 1));
    if (!corner) return std::nullopt;
    fit.corners.corners_px[i] = *corner;
    if (!pass.is_last) continue;
    fit.corners.sigma_px[i] = std::sqrt(noise.VarianceGray() * CornerVariance(sides[i], ending));
  }
  return fit;
}

// The largest allowed movement of a corner; a fit that moves it farther has failed. If cells are
// small, blur and a narrow quiet zone on dark ground pull the outline of the search inwards by up
// to two pixels per side. The fit of the whole marker recovers from this, because it knows all
// cells; the fits of single sides do not.
double MaxAllowedShiftPx(double cell_px, double of_small_cells_px) {
  return std::max(of_small_cells_px, 0.8 * cell_px);
}
constexpr double kMaxSideShiftPx = 2.0, kMaxPatternShiftPx = 4.0;

// The part of an image around a marker, with grey values in proportion to light.
struct LightPart {
  cv::Mat gray;
  Eigen::Vector2d origin_px;  // of its first pixel in the image
};

LightPart CutLight(const cv::Mat& gray, const QuadCorners& corners_px, double cell_px,
                   const ImageFormation& formation) {
  const cv::Rect part =
      PixelsAround(BoundingBox(corners_px), gray.size(), cell_px + 2 * kMaxBandPx);
  cv::Mat light;
  gray(part).convertTo(light, CV_32F);
  formation.tone().Decode(&light);
  // The whole range of eight bits keeps the rounding small in a dark picture.
  cv::normalize(light, light, 0, 255, cv::NORM_MINMAX, CV_8U);
  if (formation.parameters().is_inverted) cv::bitwise_not(light, light);
  return {light, Eigen::Vector2d(part.x, part.y)};
}

std::optional<Fit> FitBySides(const cv::Mat& gray, const QuadCorners& corners_px, int num_cells) {
  VELAMAP_CHECK(gray.type() == CV_8UC1 && num_cells > 0);
  const double cell_px = QuadMeanSide(corners_px) / num_cells;
  const double band_px = std::clamp(kBandInCells * cell_px, kMinBandPx, kMaxBandPx);
  const Pass passes[] = {{std::max(band_px, 2.0), 128, 0.1, false},
                         {band_px, kMaxEdgeSamples, 0.02, true}};
  Fit fit{{corners_px, {}}, kFirstBlurPx};
  SideFitBuffers buffers;
  for (const Pass& pass : passes) {
    const auto next =
        FitSides(gray, fit.corners.corners_px, fit.blur_px, num_cells, pass, &buffers);
    if (!next) return std::nullopt;
    fit = *next;
  }
  if (MaxCornerShift(fit.corners.corners_px, corners_px) >
      MaxAllowedShiftPx(cell_px, kMaxSideShiftPx)) {
    return std::nullopt;
  }
  return fit;
}

// Moves the sides from where the edges appear to where they are printed. The shifts belong to fits
// of whole markers; half of them counts as 1 sigma here.
void UndoShiftOfEdges(const ImageFormationParameters& formation, double side_mm, Fit* fit) {
  const QuadCorners apparent_px = fit->corners.corners_px;
  const double shift_px =
      formation.ink_spread_mm / side_mm * QuadMeanSide(apparent_px) +
      (formation.edge_shift_blurs + formation.outline_shift_blurs) * fit->blur_px;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const Eigen::Vector2d to_next =
        (apparent_px[(i + 1) % kNumCorners] - apparent_px[i]).normalized();
    const Eigen::Vector2d to_previous =
        (apparent_px[(i + kNumCorners - 1) % kNumCorners] - apparent_px[i]).normalized();
    fit->corners.corners_px[i] +=
        shift_px / std::abs(Cross(to_next, to_previous)) * (to_next + to_previous);
    fit->corners.sigma_px[i] = std::hypot(fit->corners.sigma_px[i], 0.5 * shift_px);
  }
}

}  // namespace

std::optional<RefinedCorners> RefineCornersBySides(const cv::Mat& gray,
                                                   const QuadCorners& corners_px, int num_cells) {
  const auto fit = FitBySides(gray, corners_px, num_cells);
  return fit ? std::optional(fit->corners) : std::nullopt;
}

std::optional<RefinedCorners> RefineCorners(const cv::Mat& gray, const QuadCorners& corners_px,
                                            const KnownMarker& marker,
                                            const ImageFormation& formation) {
  const cv::Mat& cells = marker.cells;
  if (!HasCells(corners_px, cells.total())) return std::nullopt;
  const double cell_px = QuadMeanSide(corners_px) / cells.rows;
  QuadCorners start_px = AlignSides(gray, corners_px, {cells}).value_or(corners_px);
  const auto fitted = FitPattern(gray, start_px, marker, formation);
  if (fitted && MaxCornerShift(fitted->corners_px, corners_px) <=
                    MaxAllowedShiftPx(cell_px, kMaxPatternShiftPx)) {
    return fitted;
  }
  LightPart part{gray, Eigen::Vector2d::Zero()};
  if (!formation.tone().IsLinear()) part = CutLight(gray, start_px, cell_px, formation);
  for (Eigen::Vector2d& corner : start_px) corner -= part.origin_px;
  auto fit = FitBySides(part.gray, start_px, cells.rows);
  if (!fit) return std::nullopt;
  UndoShiftOfEdges(formation.parameters(), marker.side_mm, &*fit);
  for (Eigen::Vector2d& corner : fit->corners.corners_px) corner += part.origin_px;
  return fit->corners;
}

}  // namespace velamap
