// The picture of a whole marker and its derivatives: the inner step of pattern_fit.h, which says
// what the model is.

#pragma once

#include <array>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/blurred_cells.h"
#include "importer/ids.h"
#include "importer/unit_square_map.h"

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
    kCount = kBendV + 2
  };
  using Vector = Eigen::Matrix<double, kCount, 1>;
  using Matrix = Eigen::Matrix<double, kCount, kCount>;
};

std::array<Eigen::Vector2d, kNumCorners> CornersOf(const PatternParameters::Vector& parameters);

// What a fit keeps fixed.
struct PatternModel {
  int num_cells = 0;  // along a side, with the border
  // Of column i, row j at (j + kRing, i + kRing): the marker's own cells; all that lies outside, as
  // if it were light; and what the surroundings depart from that.
  Lightness inner, ring, surround;
  Eigen::Vector2d center_px;
  double diagonal_px = 0.0;
};

// Fills the three pictures of cells: the marker's own (zero for black) and the quiet zone are
// known, what surrounds them is read from the image. Where it is read, blur also brings some of the
// quiet zone and of the black border; that is taken off, with the corners, blurs and grey levels of
// `parameters`. Returns the larger blur, in cells.
double FillLightness(const cv::Mat& gray, const cv::Mat& cells,
                     const PatternParameters::Vector& parameters, PatternModel* model);

// Four pixels of the model. Single precision is enough for a step.
struct PatternPixels {
  Floats gray;
  std::array<Floats, PatternParameters::kCount> jacobian;  // by the parameters
};

// The model with its parameters, ready for many pixels. Places are in OpenCV's pixel frame, less
// the model's `center_px`.
class PatternPicture {
 public:
  PatternPicture(const PatternModel& model, const PatternParameters::Vector& parameters);

  // Whether a place is no further outside the black square than the model says what is there.
  Ints Covers(Floats x, Floats y) const;  // -1 for yes

  void At(Floats x, Floats y, PatternPixels* pixels) const;

 private:
  // A place in the unit square and the derivatives of u and v on the flat marker, 1/px.
  struct Place {
    Floats u, v, u_by_x, u_by_y, v_by_x, v_by_y;
  };
  Place ToSquare(Floats x, Floats y) const;
  Blended BlendAll(const Shares& u, const Shares& v, Floats correlation_px, Floats* inner_value,
                   Floats* surround_value) const;

  const PatternModel& model_;
  PatternParameters::Vector parameters_;
  Eigen::Matrix3f square_from_image_;
  Lightness print_;  // the marker's own cells and the quiet zone, as light as the parameters say
};

}  // namespace velamap
