// What the model of pattern_fit.h is made of: its parameters, and what a fit keeps fixed.

#pragma once

#include <array>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "importer/geometry/unit_square_map.h"
#include "importer/refine/blurred_cells.h"
#include "importer/refine/camera_response.h"

namespace velamap {

struct PatternParameters {
  enum Index {
    kCorners = 0,  // x0 y0 x1 y1 ..., OpenCV's pixel frame
    kBlurU = 8,    // px
    kBlurV,
    kDark,  // grey levels
    kLight,
    kGradientX,  // relative change of the light over one side of the marker
    kGradientY,
    kSurround,    // contrast of the surroundings in parts of what the blurred image shows there
    kInnerLight,  // lightness of the marker's own light cells in parts of the quiet zone's
    kBendU,       // x y of the departure from the plane halfway along u and along v, px
    kBendV = kBendU + 2,
    kMargin = kBendV + 2,  // widths of the quiet zone beside the first and the last column, above
                           // the first and below the last row, cells
    kCount = kMargin + 4
  };
  using Vector = Eigen::Matrix<double, kCount, 1>;
  using Matrix = Eigen::Matrix<double, kCount, kCount>;
};

QuadCorners CornersOf(const PatternParameters::Vector& parameters);

// What a fit keeps fixed.
struct PatternModel {
  int num_cells = 0;      // along a side, with the border
  LightCells inner = {};  // the marker's own cells
  Lightness surround;     // how far from light the outermost ring is; the other cells are zero
  Eigen::Vector2d center_px;
  double diagonal_px = 0.0;
  double spread_cells = 0.0;  // how far the print's dark cells reach beyond their outlines
  const ToneCurve* tone = nullptr;
};

// Fills the pictures of cells: the marker's own (zero for black) are known, what surrounds the
// quiet zone is read from the image. Where it is read, blur also brings some of the quiet zone and
// of the black border; that is taken off, with the corners, blurs and grey levels of `parameters`.
// Returns the larger blur, in cells.
double FillLightness(const GrayPatch& patch, const cv::Mat& cells,
                     const PatternParameters::Vector& parameters, PatternModel* model);

}  // namespace velamap
