// Evaluates the model of pattern_fit.h and its derivatives. All of it is inline, for
// VELAMAP_CLONE_FOR_AVX2.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "importer/bend/bent_square.h"
#include "importer/lanes/blurred_cells.h"
#include "importer/pattern/pattern_model.h"

namespace velamap {

// A group of pixels of the model. Single precision is enough for a step.
struct PatternPixels {
  Floats gray;
  FloatsArray<PatternParameters::kCount> jacobian;  // with respect to the parameters
};

// Squared slope of the grey levels, (grey levels / px)^2: the derivatives with respect to all
// corners together.
inline Floats SquaredSlope(const FloatsArray<PatternParameters::kCount>& jacobian) {
  Floats slope_x{}, slope_y{};
  for (std::size_t i = 0; i < 2 * kNumCorners; i += 2) {
    slope_x += jacobian[i];
    slope_y += jacobian[i + 1];
  }
  return slope_x * slope_x + slope_y * slope_y;
}

// The model with given parameters, prepared for many pixels. Places are in OpenCV's pixel frame,
// relative to `center_px` of the model.
class PatternPicture {
 public:
  PatternPicture(const PatternModel& model, const PatternParameters::Vector& parameters)
      : model_(model),
        tone_(model.formation->tone()),
        direct_share_(static_cast<float>(1 - model.formation->parameters().halo)),
        parameters_(parameters) {
    QuadCorners quad = CornersOf(parameters);
    for (Eigen::Vector2d& corner : quad) corner -= model.center_px;
    PatternBend bend = model.lens_bend;
    bend.coefficients_px.col(0) += parameters.segment<2>(P::kBendU);
    bend.coefficients_px.col(3) += parameters.segment<2>(P::kBendV);
    square_ = BentSquare(quad, bend, model.lens_bend.coefficients_px.isZero(0) ? 2 : 3);
  }

  // Whether the model covers a place, inside or near the black square; -1 for yes.
  Ints Covers(Floats x, Floats y) const {
    const SquarePlace place = square_.At(x, y);
    const auto margin = static_cast<float>(kMarginInCells / model_.num_cells);
    return (Min(place.u, place.v) > -margin) & (Max(place.u, place.v) < 1.0f + margin);
  }

  // Whether a place is within `reach_px` of an edge between a dark and a light cell, or of the end
  // of the quiet zone; -1 for yes.
  Ints IsNearEdge(Floats x, Floats y, float reach_px) const {
    const SquarePlace place = square_.At(x, y);
    const auto n = static_cast<float>(model_.num_cells);
    const Floats cells_u = n * Sqrt(place.u_by_x * place.u_by_x + place.u_by_y * place.u_by_y);
    const Floats cells_v = n * Sqrt(place.v_by_x * place.v_by_x + place.v_by_y * place.v_by_y);
    Ints is_near{};
    for (int lane = 0; lane < kLanes; ++lane) {
      const float u = n * place.u[lane], v = n * place.v[lane];
      const float reach_u = reach_px * cells_u[lane], reach_v = reach_px * cells_v[lane];
      const bool level = IsLight(u, v);
      const bool changes = IsLight(u - reach_u, v) != level || IsLight(u + reach_u, v) != level ||
                           IsLight(u, v - reach_v) != level || IsLight(u, v + reach_v) != level;
      is_near[lane] = -static_cast<int>(changes || EndsQuietZone(u, v, reach_u, reach_v));
    }
    return is_near;
  }

  // Whether a place is at a corner of the outlines of the cells, within the smaller of both
  // reaches; -1 for yes. Printers, noise filters and compression round these corners more than the
  // blur of straight edges does.
  Ints IsAtOutlineCorner(Floats x, Floats y, float reach_px = 2.0f,
                         float reach_cells = 0.4f) const {
    const SquarePlace place = square_.At(x, y);
    const auto n = static_cast<float>(model_.num_cells);
    const Floats u = n * place.u, v = n * place.v;
    const Floats corner_u = __builtin_convertvector(Floor(u + 0.5f), Floats);
    const Floats corner_v = __builtin_convertvector(Floor(v + 0.5f), Floats);
    // Cells by px, inverted to px by cells.
    const Floats u_by_x = n * place.u_by_x, u_by_y = n * place.u_by_y;
    const Floats v_by_x = n * place.v_by_x, v_by_y = n * place.v_by_y;
    const Floats px2_by_cells2 = 1.0f / (u_by_x * v_by_y - u_by_y * v_by_x);
    const Floats du = corner_u - u, dv = corner_v - v;
    const Floats dx = px2_by_cells2 * (v_by_y * du - u_by_y * dv);
    const Floats dy = px2_by_cells2 * (u_by_x * dv - v_by_x * du);
    const Floats reach2 =
        Min(AllLanes(reach_px * reach_px), reach_cells * reach_cells * Abs(px2_by_cells2));
    Ints is_near = dx * dx + dy * dy < reach2;
    for (int lane = 0; lane < kLanes; ++lane) {
      if (is_near[lane] && !IsOutlineCorner(corner_u[lane], corner_v[lane])) is_near[lane] = 0;
    }
    return is_near;
  }

  // Whether a place is further inside the black square than half a cell; -1 for yes.
  Ints IsAmongInnerCells(Floats x, Floats y) const {
    const SquarePlace place = square_.At(x, y);
    const auto border = static_cast<float>(0.5 / model_.num_cells);
    return (Min(place.u, place.v) > border) & (Max(place.u, place.v) < 1.0f - border);
  }

  void At(Floats x, Floats y, PatternPixels* pixels) const {
    const Eigen::Matrix<float, P::kCount, 1> p = parameters_.cast<float>();
    const SquarePlace place = square_.WithBentSlopes(square_.At(x, y));
    const auto n = static_cast<float>(model_.num_cells);
    const Floats u_by_x = n * place.u_by_x, u_by_y = n * place.u_by_y;  // cells/px
    const Floats v_by_x = n * place.v_by_x, v_by_y = n * place.v_by_y;
    const Floats cells_u = Sqrt(u_by_x * u_by_x + u_by_y * u_by_y);
    const Floats cells_v = Sqrt(v_by_x * v_by_x + v_by_y * v_by_y);
    CellWeights u, v;
    const Floats blur_u = cells_u * p[P::kBlurU], blur_v = cells_v * p[P::kBlurV];
    const auto outline_shift = static_cast<float>(model_.outline_shift_blurs);
    ComputeCellWeights(n * place.u, blur_u, model_.num_cells,
                       {p[P::kMargin], p[P::kMargin + 1], outline_shift * blur_u}, &u);
    ComputeCellWeights(n * place.v, blur_v, model_.num_cells,
                       {p[P::kMargin + 2], p[P::kMargin + 3], outline_shift * blur_v}, &v);
    Floats inner{};
    BlendedSurroundings surroundings;
    Blended pattern =
        BlendAll(u, v, p[P::kBlurU] * p[P::kBlurV] * (u_by_x * v_by_x + u_by_y * v_by_y), &inner,
                 &surroundings);
    if (model_.ink_spread_cells != 0 || model_.edge_shift_blurs != 0) {
      ApplySpread(blur_u, blur_v, &pattern);
    }

    const auto inverse_diagonal = static_cast<float>(1 / model_.diagonal_px);
    const Floats place_x = inverse_diagonal * x, place_y = inverse_diagonal * y;
    const Floats lighting = LightingAt(x, y);
    const Floats light =
        lighting * (1.0f + p[P::kGradientX] * place_x + p[P::kGradientY] * place_y);
    const float step = p[P::kLight] - p[P::kDark];
    const Floats contrast = light * step;
    const Floats level = p[P::kDark] + step * pattern.value;
    const Floats by_x = contrast * (u_by_x * pattern.by_u + v_by_x * pattern.by_v);
    const Floats by_y = contrast * (u_by_y * pattern.by_u + v_by_y * pattern.by_v);
    Floats slope;
    pixels->gray = tone_.Encode(direct_share_ * light * level + Scattered(x, y), &slope);
    slope *= direct_share_;
    FloatsArray<P::kCount>& jacobian = pixels->jacobian;
    const auto set_place = [&](std::size_t index, Floats share) {
      jacobian[index] = -share * by_x;
      jacobian[index + 1] = -share * by_y;
    };
    // A moving corner shifts each place by its bilinear weight; this is accurate enough for a step.
    set_place(P::kCorners, (1.0f - place.u) * (1.0f - place.v));
    set_place(P::kCorners + 2, place.u * (1.0f - place.v));
    set_place(P::kCorners + 4, place.u * place.v);
    set_place(P::kCorners + 6, (1.0f - place.u) * place.v);
    set_place(P::kBendU, Hump(place.u));
    set_place(P::kBendV, Hump(place.v));
    AddStretch(place, blur_u, blur_v, contrast, pattern, &jacobian);
    jacobian[P::kBlurU] = contrast * cells_u * pattern.by_blur_u;
    jacobian[P::kBlurV] = contrast * cells_v * pattern.by_blur_v;
    jacobian[P::kDark] = light * (1.0f - pattern.value);
    jacobian[P::kLight] = light * pattern.value;
    jacobian[P::kGradientX] = lighting * level * place_x;
    jacobian[P::kGradientY] = lighting * level * place_y;
    jacobian[P::kSurround] = contrast * surroundings.blended.value;
    jacobian[P::kInnerLight] = contrast * inner;
    for (std::size_t i = 0; i < 4; ++i) {
      jacobian[P::kMargin + i] = contrast * p[P::kSurround] * surroundings.by_margin[i];
    }
    if (!tone_.IsLinear() || direct_share_ != 1) {
      for (Floats& derivative : jacobian) derivative *= slope;
    }
  }

 private:
  using P = PatternParameters;

  // How far outside the black square pixels are used.
  static constexpr double kMarginInCells = 0.75;

  // Moves every edge towards the light side by the ink's spread and by a fraction of its blur, to
  // second order. `blur_u`, `blur_v`: in cells. The derivatives stay as they are, which is enough
  // for a step.
  void ApplySpread(Floats blur_u, Floats blur_v, Blended* pattern) const {
    const auto ink = static_cast<float>(model_.ink_spread_cells);
    const auto share = static_cast<float>(model_.edge_shift_blurs);
    const Floats spread_u = ink + share * blur_u, spread_v = ink + share * blur_v;
    const Floats squared_u = pattern->by_u * pattern->by_u;
    const Floats squared_v = pattern->by_v * pattern->by_v;
    const Floats squared_slope = squared_u + squared_v + 1e-8f;
    const Floats by_uu = pattern->by_blur_u / blur_u, by_vv = pattern->by_blur_v / blur_v;
    const Floats bend =
        spread_u * spread_u * squared_u * by_uu +
        2.0f * spread_u * spread_v * pattern->by_u * pattern->by_v * pattern->by_u_v +
        spread_v * spread_v * squared_v * by_vv;
    pattern->value += 0.5f * bend / squared_slope -
                      (spread_u * squared_u + spread_v * squared_v) / Sqrt(squared_slope);
  }

  // A bend also changes how many cells the blur reaches, and makes the view oblique. Adds this to
  // the derivatives by the bends. `blur_u`, `blur_v`: in cells.
  void AddStretch(const SquarePlace& place, Floats blur_u, Floats blur_v, Floats contrast,
                  const Blended& pattern, FloatsArray<PatternParameters::kCount>* jacobian) const {
    const auto v_by_u = static_cast<float>(parameters_[P::kBlurV] / parameters_[P::kBlurU]);
    const Floats slope_u = contrast * (8.0f * place.u - 4.0f) * blur_u;
    const Floats slope_v = contrast * (8.0f * place.v - 4.0f) * blur_v;
    const Floats stretch_u = slope_u * pattern.by_blur_u, stretch_v = slope_v * pattern.by_blur_v;
    const Floats shear_u = slope_u * blur_u * pattern.by_u_v * v_by_u;
    const Floats shear_v = slope_v * blur_v * pattern.by_u_v / v_by_u;
    (*jacobian)[P::kBendU] += stretch_u * place.u_by_x + shear_u * place.v_by_x;
    (*jacobian)[P::kBendU + 1] += stretch_u * place.u_by_y + shear_u * place.v_by_y;
    (*jacobian)[P::kBendV] += stretch_v * place.v_by_x + shear_v * place.u_by_x;
    (*jacobian)[P::kBendV + 1] += stretch_v * place.v_by_y + shear_v * place.u_by_y;
  }

  // The light that the halo adds to the pixels nearest to the places.
  Floats Scattered(Floats x, Floats y) const {
    return model_.scattered_light.empty() ? Floats{} : NearestTo(x, y, model_.scattered_light);
  }

  Floats LightingAt(Floats x, Floats y) const {
    return model_.lighting.empty() ? AllLanes(1.0) : NearestTo(x, y, model_.lighting);
  }

  // Values of the patch's pixels.
  Floats NearestTo(Floats x, Floats y, const cv::Mat& values) const {
    const Floats column = x + static_cast<float>(model_.center_in_patch_px.x() + 0.5);
    const Floats row = y + static_cast<float>(model_.center_in_patch_px.y() + 0.5);
    Floats nearest{};
    for (int lane = 0; lane < kLanes; ++lane) {
      nearest[lane] =
          values.at<float>(std::clamp(static_cast<int>(row[lane]), 0, values.rows - 1),
                           std::clamp(static_cast<int>(column[lane]), 0, values.cols - 1));
    }
    return nearest;
  }

  // Whether the cell at a place (in cells), or the quiet zone there, is light.
  bool IsLight(float u, float v) const {
    const auto n = static_cast<float>(model_.num_cells);
    if (!(u >= 0 && v >= 0 && u < n && v < n)) return true;
    return model_.inner[static_cast<std::size_t>(v) + kRing] >> (static_cast<int>(u) + kRing) & 1;
  }

  // Whether neither two rows nor two columns of the four cells around a place are alike.
  bool IsOutlineCorner(float u, float v) const {
    const bool a = IsLight(u - 0.5f, v - 0.5f), b = IsLight(u + 0.5f, v - 0.5f);
    const bool c = IsLight(u - 0.5f, v + 0.5f), d = IsLight(u + 0.5f, v + 0.5f);
    return !(a == b && c == d) && !(a == c && b == d);
  }

  bool EndsQuietZone(float u, float v, float reach_u, float reach_v) const {
    const auto n = static_cast<double>(model_.num_cells);
    const auto margin = parameters_.segment<4>(P::kMargin);
    return std::abs(u + margin[0]) < reach_u || std::abs(u - n - margin[1]) < reach_u ||
           std::abs(v + margin[2]) < reach_v || std::abs(v - n - margin[3]) < reach_v;
  }

  Blended BlendAll(const CellWeights& u, const CellWeights& v, Floats correlation_px,
                   Floats* inner_value, BlendedSurroundings* surroundings) const {
    const int n = model_.num_cells;
    const Blended inner = BlendLight(model_.inner, u, v);
    *inner_value = inner.value;
    Blended pattern;
    if (Reaches(kRing, u, n) || Reaches(kRing, v, n)) pattern = BlendGround(u, v, n);
    Add(AllLanes(parameters_[P::kInnerLight]), inner, &pattern);
    AddCorrelation(correlation_px, &pattern);
    if (Reaches(1, u, n) || Reaches(1, v, n)) {
      *surroundings = BlendOutermost(model_.surround, u, v, n);
      Add(AllLanes(parameters_[P::kSurround]), surroundings->blended, &pattern);
    }
    return pattern;
  }

  const PatternModel& model_;
  const ToneCurve& tone_;
  float direct_share_;  // of the light, which the halo does not scatter
  PatternParameters::Vector parameters_;
  BentSquare square_;  // bent by cloth and lens
};

}  // namespace velamap
