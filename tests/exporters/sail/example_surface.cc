#include "tests/exporters/sail/example_surface.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "importer/geometry/units.h"

namespace velamap {

Eigen::Vector3d BilinearPatch(double u, double v) {
  const Eigen::Vector3d a(0, 0, 0), b(3, 0.2, 0), c(0.3, -0.1, 5), d(2.5, 1, 5.2);
  return (1 - u) * (1 - v) * a + u * (1 - v) * b + (1 - u) * v * c + u * v * d;
}

Eigen::Vector3d CylinderSail(double u, double v) {
  const double angle = 40 * kPi / 180 * (u - 0.5);
  return {4 * std::sin(angle), 4 * std::cos(angle), 3 * v};
}

Eigen::Vector3d TwistedSail(double u, double v) {
  const double chord = 3 - 2 * v;
  const double camber = (0.10 + 0.02 * v) * chord;
  const double twist = 15 * kPi / 180 * v;
  // A quartic profile with its draft at 43 % of the chord.
  const double along = chord * u;
  const double depth = camber * 4 * u * (1 - u) * (1 + 0.3 * (1 - 2 * u));
  return {std::cos(twist) * along - std::sin(twist) * depth,
          std::sin(twist) * along + std::cos(twist) * depth, 6 * v};
}

SurfaceInput MarkersOn(const SurfaceTruth& truth, int num_lines, int num_markers) {
  SurfaceInput input;
  int marker_id = 0;
  for (int j = 0; j < num_lines; ++j) {
    SurfaceLine line{"h" + std::to_string(j + 1), {}};
    for (int k = 0; k < num_markers; ++k) {
      const double u = static_cast<double>(k) / (num_markers - 1);
      const double v = static_cast<double>(j) / (num_lines - 1);
      line.markers.push_back(SurfaceMarker{marker_id++, truth(u, v), std::nullopt});
    }
    input.lines.push_back(line);
  }
  return input;
}

SurfaceInput CornersOn(const SurfaceTruth& truth, int num_lines, int num_markers, double du,
                       double dv) {
  SurfaceInput input = MarkersOn(truth, num_lines, num_markers);
  ForEachMarker(&input, [&](SurfaceMarker* marker) {
    const double u = static_cast<double>(marker->marker_id % num_markers) / (num_markers - 1);
    const double v = static_cast<double>(marker->marker_id / num_markers) / (num_lines - 1);
    marker->corners_in_shape_m = {truth(u - du, v + dv), truth(u + du, v + dv),
                                  truth(u + du, v - dv), truth(u - du, v - dv)};
    marker->x_in_shape_m.setZero();
    for (const Eigen::Vector3d& x : marker->corners_in_shape_m) marker->x_in_shape_m += x / 4;
  });
  return input;
}

SurfaceInput AsExact(SurfaceInput input) {
  ForEachMarker(&input, [](SurfaceMarker* marker) { marker->sigma_m = 0.0; });
  return input;
}

void MoveMarker(const Eigen::Vector3d& move_m, SurfaceMarker* marker) {
  marker->x_in_shape_m += move_m;
  for (Eigen::Vector3d& corner : marker->corners_in_shape_m) corner += move_m;
}

void AddNoise(double sigma_m, bool with_sigma, int seed, SurfaceInput* input) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma_m);
  ForEachMarker(input, [&](SurfaceMarker* marker) {
    for (Eigen::Vector3d& corner : marker->corners_in_shape_m) {
      const Eigen::Vector3d noise_m =
          2 * Eigen::Vector3d(normal(random), normal(random), normal(random));
      corner += noise_m;
      marker->x_in_shape_m += noise_m / 4;
    }
    if (marker->corners_in_shape_m.empty()) {
      for (double& x : marker->x_in_shape_m) x += normal(random);
    }
    if (with_sigma) marker->sigma_m = sigma_m;
  });
}

double LargestResidual(const FittedSurface& fitted) {
  return std::max(-fitted.distance_m.min, fitted.distance_m.max);
}

double LargestDistance(const SplineSurface& surface, const SurfaceTruth& truth) {
  constexpr int kSteps = 30;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      points.push_back(truth(static_cast<double>(i) / kSteps, static_cast<double>(j) / kSteps));
    }
  }
  double largest = 0.0;
  for (const SurfaceFoot& foot : ProjectOnSurface(surface, points)) {
    largest = std::max(largest, std::hypot(foot.distance_m, foot.beyond_edge_m));
  }
  return largest;
}

double TruthRms(const SplineSurface& surface, const SurfaceTruth& truth) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 1; i < 20; ++i) {
    for (int j = 1; j < 20; ++j) points.push_back(truth(i / 20.0, j / 20.0));
  }
  std::vector<double> distances;
  for (const SurfaceFoot& foot : ProjectOnSurface(surface, points)) {
    distances.push_back(foot.distance_m);
  }
  return ComputeStatistics(distances).rms;
}

SurfaceInput NoisySail() {
  SurfaceInput input = CornersOn(TwistedSail, 7, 9, 0.02, 0.01);
  AddNoise(0.002, true, 1, &input);
  return input;
}

}  // namespace velamap
