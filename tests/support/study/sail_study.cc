#include "tests/support/study/sail_study.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kSpacing_m = 0.15;
constexpr int kNumLines = 7, kNumBetween = 4;
constexpr int kMinMarkers = 5;
// Sigma of the tilts over that of the means, as in shapes from rendered clips.
constexpr double kTiltNoise = 0.5;

double Uniform(double low, double high, std::mt19937* random) {
  return std::uniform_real_distribution<double>(low, high)(*random);
}

// Partial derivatives by central differences.
struct Derivatives {
  Eigen::Vector3d x, u, v, uu, uv, vv;
};

Derivatives Differentiate(const Surface& sail, const Eigen::Vector2d& uv) {
  constexpr double kStep = 1e-4;
  const Eigen::Vector2d du(kStep, 0), dv(0, kStep);
  const auto at = [&](const Eigen::Vector2d& offset) { return sail(uv + offset); };
  Derivatives result;
  result.x = sail(uv);
  result.u = (at(du) - at(-du)) / (2 * kStep);
  result.v = (at(dv) - at(-dv)) / (2 * kStep);
  result.uu = (at(du) - 2 * result.x + at(-du)) / (kStep * kStep);
  result.vv = (at(dv) - 2 * result.x + at(-dv)) / (kStep * kStep);
  result.uv = (at(du + dv) - at(du - dv) - at(dv - du) + at(-du - dv)) / (4 * kStep * kStep);
  return result;
}

// Normal curvature along the part of a direction that lies in the tangent plane.
double CurvatureAlong(const Derivatives& jet, const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> tangents;
  tangents << jet.u, jet.v;
  const Eigen::Matrix2d first = tangents.transpose() * tangents;
  const Eigen::Vector2d step = first.inverse() * (tangents.transpose() * direction);
  const Eigen::Vector3d normal = jet.u.cross(jet.v).normalized();
  Eigen::Matrix2d second;
  second << normal.dot(jet.uu), normal.dot(jet.uv), normal.dot(jet.uv), normal.dot(jet.vv);
  return step.dot(second * step) / step.dot(first * step);
}

double ChordLength(const Surface& sail, double v) { return (sail({1, v}) - sail({0, v})).norm(); }

// The value between the lines.
double Between(const std::vector<double>& vs, const std::vector<double>& values, double v) {
  const auto above = std::upper_bound(vs.begin() + 1, vs.end() - 1, v);
  const auto k = static_cast<std::size_t>(above - vs.begin());
  const double part = (v - vs[k - 1]) / (vs[k] - vs[k - 1]);
  return values[k - 1] + part * (values[k] - values[k - 1]);
}

// The corners lie on the cloth. All of them share the noise of their mean.
SurfaceMarker DrawMarker(int marker_id, const Surface& sail, const Eigen::Vector2d& uv,
                         double sigma_m, std::mt19937* random) {
  constexpr double kHalfSide_m = 0.05;
  std::normal_distribution<double> unit(0, 1);
  const auto draw = [&](double sigma) -> Eigen::Vector3d {
    return sigma * Eigen::Vector3d(unit(*random), unit(*random), unit(*random));
  };
  SurfaceMarker marker{marker_id, Eigen::Vector3d::Zero(), sigma_m, {}, kTiltNoise * sigma_m};
  const Derivatives jet = Differentiate(sail, uv);
  Eigen::Matrix<double, 3, 2> tangents, sides;
  tangents << jet.u, jet.v;
  sides.col(0) = jet.u.normalized();
  sides.col(1) = jet.u.cross(jet.v).cross(jet.u).normalized();
  const Eigen::Matrix2d uv_from_sides =
      (tangents.transpose() * tangents).inverse() * tangents.transpose() * sides;
  Eigen::Vector3d mean_noise = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& side : {Eigen::Vector2d(-1, 1), Eigen::Vector2d(1, 1),
                                      Eigen::Vector2d(1, -1), Eigen::Vector2d(-1, -1)}) {
    const Eigen::Vector3d noise = draw(2 * kTiltNoise * sigma_m);
    marker.corners_in_shape_m.push_back(sail(uv + uv_from_sides * (kHalfSide_m * side)) + noise);
    mean_noise += noise / 4;
  }
  const Eigen::Vector3d shared = draw(sigma_m) - mean_noise;
  for (Eigen::Vector3d& corner : marker.corners_in_shape_m) {
    corner += shared;
    marker.x_in_shape_m += corner / 4;
  }
  return marker;
}

}  // namespace

Surface DrawSail(std::mt19937* random) {
  const double foot_m = Uniform(2, 4, random), luff_m = Uniform(5, 8, random);
  const double camber = Uniform(0.06, 0.14, random), more = Uniform(-0.02, 0.03, random);
  const double twist_rad = Uniform(3, 25, random) * kRadPerDeg;
  const double bend_m = Uniform(0, 0.12, random), roach = Uniform(0.6, 1.0, random);
  const double a = Uniform(1.4, 1.9, random);
  const double deepest = (1 + a - std::sqrt((1 + a) * (1 + a) - 3 * a)) / 3;
  const double largest = deepest * (1 - deepest) * (a - deepest);
  return [=](const Eigen::Vector2d& uv) -> Eigen::Vector3d {
    const double u = uv.x(), v = uv.y(), angle = twist_rad * v;
    const double depth = u * (1 - u) * (a - u) / largest;
    const double chord_m = foot_m * std::pow(std::max(1 - v, 0.0), roach) + 0.05;
    const Eigen::Vector3d along(std::cos(angle), -std::sin(angle), 0);
    const Eigen::Vector3d out(-std::sin(angle), -std::cos(angle), 0);
    const Eigen::Vector3d luff(-4 * bend_m * v * (1 - v), 0, luff_m * v);
    return luff + chord_m * (u * along + (camber + more * v) * depth * out);
  };
}

SailLines DrawLines(const Surface& sail, std::mt19937* random) {
  constexpr double kLowest = 0.05, kHighest = 0.86;
  SailLines lines;
  for (int k = 0; k < kNumLines; ++k) {
    const double v = kLowest + (kHighest - kLowest) * k / (kNumLines - 1);
    const double chord_m = ChordLength(sail, v);
    lines.vs.push_back(v);
    lines.first_us.push_back(Uniform(0.05, 0.12, random) / chord_m);
    lines.last_us.push_back(1 - Uniform(0.05, 0.12, random) / chord_m);
  }
  return lines;
}

double MarkerSigma(double sigma_m, double fraction) {
  return sigma_m * (1 + 2 * std::pow(2 * fraction - 1, 4));
}

SurfaceInput DrawMarkers(const Surface& sail, const SailLines& lines, double sigma_m,
                         std::mt19937* random) {
  int next_id = 0;
  const auto draw = [&](double u, double v, double sigma) {
    return DrawMarker(next_id++, sail, {u, v}, sigma, random);
  };
  SurfaceInput input;
  for (std::size_t k = 0; k < lines.vs.size(); ++k) {
    const double first = lines.first_us[k], last = lines.last_us[k];
    const double length_m = (last - first) * ChordLength(sail, lines.vs[k]);
    const int n = std::max(kMinMarkers, 1 + static_cast<int>(length_m / kSpacing_m));
    SurfaceLine line{fmt::format("h{}", k + 1), {}};
    for (int i = 0; i < n; ++i) {
      const double fraction = static_cast<double>(i) / (n - 1);
      line.markers.push_back(
          draw(first + (last - first) * fraction, lines.vs[k], MarkerSigma(sigma_m, fraction)));
    }
    input.lines.push_back(line);
  }
  for (std::size_t k = 1; k < lines.vs.size(); ++k) {
    for (int i = 1; i <= kNumBetween; ++i) {
      const double part = static_cast<double>(i) / (kNumBetween + 1);
      const double v = lines.vs[k - 1] + part * (lines.vs[k] - lines.vs[k - 1]);
      input.markers.push_back(draw(Uniform(0.44, 0.46, random), v, sigma_m));
    }
  }
  return input;
}

std::vector<SurfaceError> MeasureSurface(const SplineSurface& surface, const Surface& sail,
                                         const SailLines& lines) {
  const int num_up = kNumPlacesPerGap * (static_cast<int>(lines.vs.size()) - 1);
  std::vector<SurfaceError> errors;
  std::vector<Eigen::Vector3d> places;
  std::vector<Eigen::Vector3d> directions;
  for (int j = 0; j <= num_up; ++j) {
    for (int i = 0; i < kNumPlacesAlong; ++i) {
      SurfaceError error;
      error.along = static_cast<double>(i) / (kNumPlacesAlong - 1);
      error.up = static_cast<double>(j) / num_up;
      const double v = lines.vs.front() + error.up * (lines.vs.back() - lines.vs.front());
      const double first = Between(lines.vs, lines.first_us, v);
      const double last = Between(lines.vs, lines.last_us, v);
      const Derivatives truth = Differentiate(sail, {first + error.along * (last - first), v});
      error.x_in_sail_m = truth.x;
      error.curvature = CurvatureAlong(truth, truth.u);
      const double to_end_m =
          std::min(error.along, 1 - error.along) * (last - first) * ChordLength(sail, v);
      error.is_inside =
          to_end_m > kSpacing_m && j >= kNumPlacesPerGap && j <= num_up - kNumPlacesPerGap;
      places.push_back(truth.x);
      directions.push_back(truth.u);
      errors.push_back(error);
    }
  }
  const std::vector<SurfaceFoot> feet = ProjectOnSurface(surface, places);
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const SurfaceJet jet = EvaluateJet(surface, feet[k].u, feet[k].v);
    errors[k].distance_m = feet[k].distance_m;
    errors[k].found_curvature =
        CurvatureAlong({jet.x, jet.x_u, jet.x_v, jet.x_uu, jet.x_uv, jet.x_vv}, directions[k]);
  }
  return errors;
}

}  // namespace velamap
