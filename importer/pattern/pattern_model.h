// The parameters and the constants of the model of pattern_fit.h.

#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/bend/pattern_bend.h"
#include "importer/geometry/quad.h"
#include "importer/geometry/unit_square_map.h"
#include "importer/lanes/blurred_cells.h"
#include "importer/pattern/image_formation.h"

namespace velamap {

struct PatternParameters {
  enum Index {
    kCorners = 0,  // x0 y0 x1 y1 ..., OpenCV's pixel frame
    kBlurU = 8,    // px
    kBlurV,
    kDark,  // light, 0 to 255
    kLight,
    kGradientX,  // relative change of the light over one side of the marker
    kGradientY,
    kSurround,    // contrast of the surroundings relative to the blurred image
    kInnerLight,  // lightness of the marker's light cells relative to the quiet zone
    kBendU,       // x y of the deviation from the plane in the middle of u and of v, px
    kBendV = kBendU + 2,
    kMargin = kBendV + 2,  // width of the quiet zone before the first and after the last column,
                           // before the first and after the last row, cells
    kCount = kMargin + 4
  };
  using Vector = Eigen::Matrix<double, kCount, 1>;
  using Matrix = Eigen::Matrix<double, kCount, kCount>;
};

QuadCorners CornersOf(const PatternParameters::Vector& parameters);

// Sigma of the blur across columns and across rows, in cells at the centre of the marker.
Eigen::Vector2d BlurInCells(const PatternParameters::Vector& parameters, int num_cells);

// The constants of a fit.
struct PatternModel {
  int num_cells = 0;      // along a side, with the border
  LightCells inner = {};  // the cells of the marker
  Lightness surround;     // of the outermost ring, relative to light; the other cells are zero
  Eigen::Vector2d center_px;
  double diagonal_px = 0.0;
  double side_mm = 100.0;  // of the black square
  PatternBend lens_bend;
  double ink_spread_cells = 0.0;       // how far dark cells reach beyond their outlines
  double edge_shift_blurs = 0.0;       // how far the camera moves them further, in blur sigmas
  double outline_shift_blurs = 0.0;    // how far the outline of the square lies further outside
  double outline_corner_weight = 1.0;  // of the pixels at the corners of the cells' outlines
  const ImageFormation* formation = nullptr;
  cv::Mat scattered_light;  // of the patch
  cv::Mat lighting;         // CV_32F, of the patch: factors of the light; empty: one (lighting.h)
  Eigen::Vector2d center_in_patch_px;
};

// Fills in the lightness of the cells: those of the marker are known (zero for black), the
// surroundings of the quiet zone are read from the image. The quiet zone and the black border blur
// into the places where it is read; their contribution is subtracted, as computed from the corners,
// blurs and grey levels of `parameters`.
void FillLightness(const GrayPatch& patch, const cv::Mat& cells,
                   const PatternParameters::Vector& parameters, PatternModel* model);

}  // namespace velamap
