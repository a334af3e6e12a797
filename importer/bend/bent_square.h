// From pixels to places on a marker that cloth and lens bend. All of it is inline, for
// VELAMAP_CLONE_FOR_AVX2.

#pragma once

#include <Eigen/Core>

#include "importer/bend/pattern_bend.h"
#include "importer/geometry/quad.h"
#include "importer/geometry/unit_square_map.h"
#include "importer/lanes/float_lanes.h"

namespace velamap {

// A place in the unit square and the derivatives of u and v by those in the image, 1/px.
struct SquarePlace {
  Floats u, v, u_by_x, u_by_y, v_by_x, v_by_y;
};

// Zero at both ends of a side, one in its middle.
inline Floats Hump(Floats place) { return 4.0f * place * (1.0f - place); }

class BentSquare {
 public:
  BentSquare() = default;

  // `num_rounds`: how often the bend is evaluated until it is undone to 0.01 px.
  BentSquare(const QuadCorners& corners_px, const PatternBend& bend, int num_rounds)
      : square_from_image_(UnitSquareMap(corners_px).square_from_image().cast<float>()),
        bends_px_(bend.coefficients_px.cast<float>()),
        num_rounds_(num_rounds) {}

  // With the slopes of the flat marker.
  SquarePlace At(Floats x, Floats y) const {
    const Eigen::Matrix3f& m = square_from_image_;
    const Floats scale = 1.0f / (m(2, 0) * x + m(2, 1) * y + m(2, 2));
    const Floats flat_u = scale * (m(0, 0) * x + m(0, 1) * y + m(0, 2));
    const Floats flat_v = scale * (m(1, 0) * x + m(1, 1) * y + m(1, 2));
    SquarePlace place{flat_u,
                      flat_v,
                      scale * (m(0, 0) - flat_u * m(2, 0)),
                      scale * (m(0, 1) - flat_u * m(2, 1)),
                      scale * (m(1, 0) - flat_v * m(2, 0)),
                      scale * (m(1, 1) - flat_v * m(2, 1))};
    const Eigen::Matrix<float, 2, 6>& b = bends_px_;
    for (int i = 0; i < num_rounds_; ++i) {
      const Floats hump_u = Hump(place.u), hump_v = Hump(place.v);
      const Floats tilt_u = 2.0f * place.u - 1.0f, tilt_v = 2.0f * place.v - 1.0f;
      const auto bend = [&](int axis) {
        return hump_u * (b(axis, 0) + tilt_v * b(axis, 1) + tilt_u * b(axis, 2)) +
               hump_v * (b(axis, 3) + tilt_u * b(axis, 4) + tilt_v * b(axis, 5));
      };
      const Floats bend_x = bend(0), bend_y = bend(1);
      place.u = flat_u - place.u_by_x * bend_x - place.u_by_y * bend_y;
      place.v = flat_v - place.v_by_x * bend_x - place.v_by_y * bend_y;
    }
    return place;
  }

  // A bend compresses one end of a side and stretches the other, and with them the cells that the
  // blur reaches. `flat` has the slopes of the flat marker.
  SquarePlace WithBentSlopes(const SquarePlace& flat) const {
    const Eigen::Matrix<float, 2, 6>& b = bends_px_;
    const Floats hump_u = Hump(flat.u), hump_v = Hump(flat.v);
    const Floats tilt_u = 2.0f * flat.u - 1.0f, tilt_v = 2.0f * flat.v - 1.0f;
    const auto by_u = [&](int axis) {
      return 2.0f * (hump_u * b(axis, 2) + hump_v * b(axis, 4)) -
             4.0f * tilt_u * (b(axis, 0) + tilt_v * b(axis, 1) + tilt_u * b(axis, 2));
    };
    const auto by_v = [&](int axis) {
      return 2.0f * (hump_u * b(axis, 1) + hump_v * b(axis, 5)) -
             4.0f * tilt_v * (b(axis, 3) + tilt_u * b(axis, 4) + tilt_v * b(axis, 5));
    };
    const Floats x_by_u = by_u(0), y_by_u = by_u(1), x_by_v = by_v(0), y_by_v = by_v(1);
    // The place on the flat marker by that on the bent one, and its inverse.
    const Floats uu = 1.0f + flat.u_by_x * x_by_u + flat.u_by_y * y_by_u;
    const Floats uv = flat.u_by_x * x_by_v + flat.u_by_y * y_by_v;
    const Floats vu = flat.v_by_x * x_by_u + flat.v_by_y * y_by_u;
    const Floats vv = 1.0f + flat.v_by_x * x_by_v + flat.v_by_y * y_by_v;
    const Floats by_determinant = 1.0f / (uu * vv - uv * vu);
    return {flat.u,
            flat.v,
            by_determinant * (vv * flat.u_by_x - uv * flat.v_by_x),
            by_determinant * (vv * flat.u_by_y - uv * flat.v_by_y),
            by_determinant * (uu * flat.v_by_x - vu * flat.u_by_x),
            by_determinant * (uu * flat.v_by_y - vu * flat.u_by_y)};
  }

 private:
  Eigen::Matrix3f square_from_image_ = Eigen::Matrix3f::Identity();
  Eigen::Matrix<float, 2, 6> bends_px_ = Eigen::Matrix<float, 2, 6>::Zero();  // as in PatternBend
  int num_rounds_ = 0;
};

}  // namespace velamap
