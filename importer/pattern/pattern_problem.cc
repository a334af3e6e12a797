#include "importer/pattern/pattern_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "importer/detect/gray_levels.h"
#include "importer/geometry/least_squares.h"
#include "importer/geometry/unit_square_map.h"
#include "importer/pattern/pattern_picture.h"
#include "importer/pattern/pattern_pixels.h"
#include "importer/pattern/pattern_start.h"

namespace velamap {
namespace {

using P = PatternParameters;

constexpr double kMinBlurPx = 0.3;
constexpr int kFirstPixels = 200;

VELAMAP_CLONE_FOR_AVX2 void SumUp(const PatternProblem& problem, const ChosenPixels& pixels,
                                  const P::Vector& parameters, bool with_hessian,
                                  PatternEquations* equations) {
  const PatternPicture picture(problem.model, parameters);
  equations->Clear(with_hessian);
  PatternPixels modelled;
  const bool is_weighted = problem.model.outline_corner_weight < 1;
  int left = pixels.count;
  for (const ChosenPixels::Group& group : pixels.groups) {
    picture.At(group.x, group.y, &modelled);
    if (is_weighted) {
      for (Floats& derivative : modelled.jacobian) derivative *= group.root_weight;
    }
    equations->Add(&modelled.jacobian, group.root_weight * (modelled.gray - group.gray), left);
    left -= kLanes;
  }
  equations->Finish(parameters - problem.mean, problem.weight);
}

// Enlarged pictures, and large markers that are out of focus, have a wide blur. If it is wider than
// half a cell, the cells merge.
double MaxBlurPx(const PatternModel& model) {
  constexpr double kUsual = 4.0, kOfCell = 0.5;
  const double cell_px = model.diagonal_px / (std::sqrt(2.0) * model.num_cells);
  return std::max(kUsual, kOfCell * cell_px);
}

// The fit to some pixels as a problem of MinimizeSquares().
struct PixelFit {
  using Parameters = P::Vector;
  using Equations = PatternEquations;
  using Step = P::Vector;

  const PatternProblem& problem;
  const ChosenPixels& pixels;

  void Evaluate(const P::Vector& parameters, bool with_hessian, Equations* equations) const {
    SumUp(problem, pixels, parameters, with_hessian, equations);
  }
  P::Vector Plus(const P::Vector& parameters, const P::Vector& step) const {
    return parameters + step;
  }
  // How far a corner moves, px.
  double StepSize(const P::Vector& step, const Equations&) const {
    return step.head<8>().cwiseAbs().maxCoeff();
  }
  P::Vector LimitStep(const P::Vector& parameters, P::Vector step) const {
    for (const int index : {P::kBlurU, P::kBlurV}) {
      LimitParameter(kMinBlurPx, MaxBlurPx(problem.model), parameters[index], &step[index]);
    }
    for (int index = P::kMargin; index < P::kMargin + 4; ++index) {
      LimitParameter(kMinMargin, kMaxMargin, parameters[index], &step[index]);
    }
    return step;
  }
  void Predict(const P::Vector& step, Equations* equations) const { equations->Predict(step); }
};

// Fits about `max_pixels` pixels until a step moves no corner further than `tolerance_px`. Returns
// false for too few pixels or a singular system.
bool Minimize(const PatternProblem& problem, int max_pixels, double tolerance_px,
              PatternMinimum* minimum) {
  const ChosenPixels pixels = ChoosePixels(problem, minimum->parameters, max_pixels);
  if (pixels.count <= P::kCount) return false;
  minimum->equations.Reserve(pixels.groups.size());
  LeastSquaresOptions options;
  options.initial_damping = 1e-3;
  options.min_step = tolerance_px;
  options.min_step_for_new_hessian = 0.1;
  return MinimizeSquares(options, PixelFit{problem, pixels}, &minimum->parameters,
                         &minimum->equations) != Convergence::kFailed;
}

// The pixels of the image that the quiet zone of one cell can reach; nothing if the marker
// leaves the image.
std::optional<cv::Rect> CoveredBox(const QuadCorners& corners_px, const UnitSquareMap& map,
                                   int num_cells, const cv::Mat& gray) {
  const double reach = 1.0 / num_cells;
  const Box marker = BoundingBox(corners_px);
  const Box covered =
      BoundingBox({map.ToImage(-reach, -reach), map.ToImage(1 + reach, -reach),
                   map.ToImage(1 + reach, 1 + reach), map.ToImage(-reach, 1 + reach)});
  if (!covered.min.allFinite() || !covered.max.allFinite() || marker.min.minCoeff() < 0 ||
      marker.max.x() > gray.cols - 1 || marker.max.y() > gray.rows - 1) {
    return std::nullopt;
  }
  const Eigen::Vector2d low = covered.min.cwiseMax(0.0);
  const Eigen::Vector2d high = covered.max.cwiseMin(Eigen::Vector2d(gray.cols - 1, gray.rows - 1));
  return cv::Rect(cv::Point(static_cast<int>(low.x()), static_cast<int>(low.y())),
                  cv::Point(static_cast<int>(high.x()) + 1, static_cast<int>(high.y()) + 1));
}

// Whether the surroundings were read wrongly. They are read with the levels, the blur and the
// widths of the quiet zone that are known by then. If these were wrong, as under a wide blur or if
// a background brighter than the paper was taken for the quiet zone, the fit moves the contrast of
// the surroundings away from the value read, and the prior of this contrast displaces the edges.
bool ReadSurroundingsWrongly(const PatternMinimum& minimum) {
  constexpr double kMaxContrastError = 0.03;  // relative
  return std::abs(minimum.parameters[P::kSurround] - 1) > kMaxContrastError;
}

}  // namespace

std::optional<PatternProblem> MakePatternProblem(const cv::Mat& gray, const QuadCorners& corners_px,
                                                 const KnownMarker& marker,
                                                 const ImageFormation& formation,
                                                 PatternMinimum* minimum) {
  PatternProblem problem;
  problem.cells = marker.cells;
  problem.model.num_cells = marker.cells.rows;
  problem.model.side_mm = marker.side_mm;
  problem.model.lens_bend = marker.lens_bend;
  if (problem.model.num_cells + 2 * kRing > kMaxRingedCells) return std::nullopt;
  const UnitSquareMap map(corners_px);
  const auto box = CoveredBox(corners_px, map, marker.cells.rows, gray);
  if (!box) return std::nullopt;
  problem.box = *box;
  // The surroundings are read up to two cells away.
  const cv::Point beyond(box->width / 4 + 3, box->height / 4 + 3);
  problem.model.center_px = map.ToImage(0.5, 0.5);
  SetPatch(CutPatch(gray, cv::Rect(box->tl() - beyond, box->br() + beyond), formation), &problem);
  SetFormation(formation, &problem);
  problem.model.diagonal_px =
      0.5 * ((corners_px[2] - corners_px[0]).norm() + (corners_px[3] - corners_px[1]).norm());
  if (!StartPatternFit(corners_px, formation.parameters(), &problem, minimum)) return std::nullopt;
  return problem;
}

double ContrastOf(const PatternProblem& problem, const PatternMinimum& minimum) {
  const ToneCurve& tone = problem.model.formation->tone();
  return tone.Encode(minimum.parameters[P::kLight]) - tone.Encode(minimum.parameters[P::kDark]);
}

void SetPatch(GrayPatch patch, PatternProblem* problem) {
  problem->patch = std::move(patch);
  problem->model.scattered_light = problem->patch.scattered_light;
  const cv::Point& origin_px = problem->patch.origin_px;
  problem->model.center_in_patch_px =
      problem->model.center_px - Eigen::Vector2d(origin_px.x, origin_px.y);
}

void SetFormation(const ImageFormation& formation, PatternProblem* problem) {
  const ImageFormationParameters& parameters = formation.parameters();
  PatternModel& model = problem->model;
  model.formation = &formation;
  model.ink_spread_cells = parameters.ink_spread_mm / model.side_mm * model.num_cells;
  model.edge_shift_blurs = parameters.edge_shift_blurs;
  model.outline_shift_blurs = parameters.outline_shift_blurs;
  model.outline_corner_weight = parameters.outline_corner_weight;
}

void SetQuietZonePrior(const ImageFormationParameters& formation, PatternProblem* problem) {
  const double weight = kPixelNoise / formation.quiet_zone_sigma_cells;
  problem->mean.segment<4>(P::kMargin).setConstant(formation.quiet_zone_cells);
  problem->weight.segment<4>(P::kMargin).setConstant(weight * weight);
}

bool RefinePatternFit(int max_pixels, double tolerance_px, PatternProblem* problem,
                      PatternMinimum* minimum) {
  FillLightness(problem->patch, problem->cells, minimum->parameters, &problem->model);
  return Minimize(*problem, max_pixels, tolerance_px, minimum);
}

bool FitPatternInPasses(PatternProblem* problem, PatternMinimum* minimum) {
  constexpr double kCoarsePx = 0.1;
  constexpr double kWideBlur = 0.3;  // cells
  constexpr int kMaxPasses = 4;
  FillLightness(problem->patch, problem->cells, minimum->parameters, &problem->model);
  if (!Minimize(*problem, kFirstPixels, kCoarsePx, minimum)) return false;
  int num_passes = 0;
  do {
    if (!RefinePatternFit(kMaxPatternPixels, kPatternTolerancePx, problem, minimum)) return false;
    ++num_passes;
  } while ((num_passes == 1 &&
            BlurInCells(minimum->parameters, problem->model.num_cells).maxCoeff() > kWideBlur) ||
           (num_passes < kMaxPasses && ReadSurroundingsWrongly(*minimum)));
  const double contrast = ContrastOf(*problem, *minimum);
  return contrast > kMinContrast && minimum->equations.Rms() < kMaxRelativeRms * contrast;
}

}  // namespace velamap
