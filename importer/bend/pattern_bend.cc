#include "importer/bend/pattern_bend.h"

#include <Eigen/LU>
#include <Eigen/QR>

#include "importer/geometry/unit_square_map.h"

namespace velamap {
namespace {

constexpr int kGridPlacesASide = 5;
constexpr int kNumGridPlaces = kGridPlacesASide * kGridPlacesASide;

double Hump(double t) { return 4 * t * (1 - t); }

Eigen::Vector2d GridPlace(int idx) {
  constexpr double kStep = 1.0 / (kGridPlacesASide - 1);
  return {kStep * (idx % kGridPlacesASide), kStep * (idx / kGridPlacesASide)};
}

// The coefficients that fit displacements at all places best, as a linear function of these.
Eigen::Matrix<double, 6, kNumGridPlaces> CoefficientsByDisplacements() {
  Eigen::Matrix<double, kNumGridPlaces, 6> terms;
  for (int i = 0; i < kNumGridPlaces; ++i) {
    terms.row(i) = PatternBend::TermsAt(GridPlace(i).x(), GridPlace(i).y()).transpose();
  }
  return terms.colPivHouseholderQr().solve(
      Eigen::Matrix<double, kNumGridPlaces, kNumGridPlaces>::Identity());
}

}  // namespace

PatternBend::Terms PatternBend::TermsAt(double u, double v) {
  const double tilt_u = 2 * u - 1, tilt_v = 2 * v - 1;
  Terms terms;
  terms << Hump(u) * Eigen::Vector3d(1, tilt_v, tilt_u),
      Hump(v) * Eigen::Vector3d(1, tilt_u, tilt_v);
  return terms;
}

Eigen::Vector2d PatternBend::At(double u, double v) const {
  return coefficients_px * TermsAt(u, v);
}

PatternBend BendByDisplacements(
    const std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& uv)>&
        displacement_px) {
  constexpr double kNegligible_px = 1e-6;
  static const auto kByDisplacements = CoefficientsByDisplacements();
  Eigen::Matrix<double, 2, kNumGridPlaces> displacements_px;
  for (int i = 0; i < kNumGridPlaces; ++i) {
    const auto displacement = displacement_px(GridPlace(i));
    if (!displacement) return {};
    displacements_px.col(i) = *displacement;
  }
  if (!displacements_px.allFinite() || displacements_px.cwiseAbs().maxCoeff() < kNegligible_px) {
    return {};
  }
  return {displacements_px * kByDisplacements.transpose()};
}

PatternBend BendByLens(const Camera& camera, const QuadCorners& corners_px) {
  const Eigen::Vector2d image_from_opencv = Eigen::Vector2d::Constant(kImageFromOpenCvPx);
  QuadCorners rays;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const auto ray = CamFromImage(camera, corners_px[i] + image_from_opencv);
    if (!ray) return {};
    rays[i] = *ray;
  }
  const UnitSquareMap flat_map(corners_px), ray_map(rays);
  return BendByDisplacements([&](const Eigen::Vector2d& uv) -> std::optional<Eigen::Vector2d> {
    const Eigen::Vector2d ray = ray_map.ToImage(uv.x(), uv.y());
    const auto x_px = ImageFromCam(camera, ray.homogeneous());
    if (!x_px) return std::nullopt;
    return *x_px - image_from_opencv - flat_map.ToImage(uv.x(), uv.y());
  });
}

// The fit follows c0 and c3 with a hump and the other terms in the least-squares sense. An edge
// shows only what displaces it across. For edges along u, with s = 2v - 1 and t = 2u - 1, the mean
// over the outline (|s| = 1) and half of the inner edges of 6 x 6 cells (|s| and |t| <= 2/3) turns
//
//   s h(u) into 0.696 s,  s h(v) into 0.097 s,  t h(u) into 0.490 t,  t h(v) into 0.210 t,
//
// and the same holds for edges along v with u and v exchanged.
QuadCorners CornerShiftsByBend(const PatternBend& bend, const QuadCorners& corners_px) {
  constexpr double kSByU = 0.696, kSByV = 0.097, kTByU = 0.490, kTByV = 0.210;
  const auto& c = bend.coefficients_px;
  Eigen::Matrix2d sides_px;  // along u and v
  sides_px.col(0) = corners_px[1] - corners_px[0] + corners_px[2] - corners_px[3];
  sides_px.col(1) = corners_px[3] - corners_px[0] + corners_px[2] - corners_px[1];
  const Eigen::Matrix2d by_sides = sides_px.inverse();
  // What displaces edges along u across is the part along v, and vice versa.
  const auto across = [&](int side, const Eigen::Vector2d& shift_px) -> Eigen::Vector2d {
    return sides_px.col(side) * by_sides.row(side).dot(shift_px);
  };
  const Eigen::Vector2d by_s = across(1, kSByU * c.col(1) + kSByV * c.col(5)) +
                               across(0, kTByU * c.col(5) + kTByV * c.col(1));
  const Eigen::Vector2d by_t = across(1, kTByU * c.col(2) + kTByV * c.col(4)) +
                               across(0, kSByU * c.col(4) + kSByV * c.col(2));
  return {-by_s - by_t, -by_s + by_t, by_s + by_t, by_s - by_t};
}

}  // namespace velamap
