#include "exporters/compare/mesh_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "exporters/compare/comparison_sigma.h"
#include "importer/base/error.h"
#include "importer/geometry/least_squares.h"

namespace velamap {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr std::size_t kMinPoints = 6;
constexpr std::size_t kMaxCoarsePoints = 150;
constexpr int kCoarseIterations = 25;
constexpr int kFineIterations = 100;
constexpr std::size_t kNumFineStarts = 4;
constexpr double kTrim = 0.8;     // of the points count when poses are compared
constexpr double kTukey = 4.685;  // 95 % efficiency for normal noise (Huber, 1981)
constexpr double kMadToSigma = 1.4826;
constexpr double kFloor = 1e-9;         // of the diagonal: residuals below this are zero
constexpr double kConverged = 1e-11;    // of the diagonal, a step
constexpr double kMaxTurn_rad = 0.5;    // of one step
constexpr double kAlsoFits = 1.2;       // another pose with up to this times the cost
constexpr double kOtherPose_rad = 0.1;  // turned by more than this it is another pose

struct Corners {
  std::vector<CornerId> ids;
  Points x_in_shape_m;
};

Corners CollectCorners(const MarkerShape& shape) {
  Corners corners;
  for (const ShapeMarker& marker : shape.markers) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const auto& x = marker.x_in_shape_m[static_cast<std::size_t>(corner)];
      if (!x) continue;
      corners.ids.push_back({marker.marker_id, corner});
      corners.x_in_shape_m.push_back(*x);
    }
  }
  return corners;
}

Points Thinned(const Points& points, std::size_t max_num) {
  if (points.size() <= max_num) return points;
  Points thinned;
  for (std::size_t i = 0; i < max_num; ++i) {
    thinned.push_back(points[i * points.size() / max_num]);
  }
  return thinned;
}

struct Residual {
  Eigen::Vector3d x_m;        // of the moved point
  Eigen::Vector3d direction;  // along which its distance grows
  double distance_m = 0.0;    // along it
  bool is_over_surface = false;
};

std::vector<Residual> ComputeResiduals(const Points& points, const Rigid3& pose,
                                       const MeshDistance& mesh) {
  std::vector<Residual> residuals;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d x = pose * point;
    const MeshFoot foot = mesh.Project(x);
    Residual residual{x, foot.normal, foot.distance_m, foot.IsOverSurface(mesh.Diagonal_m())};
    if (!residual.is_over_surface) {
      residual.distance_m = (x - foot.x_m).norm();
      residual.direction = (x - foot.x_m) / residual.distance_m;
    }
    residuals.push_back(residual);
  }
  return residuals;
}

// Root of the mean of the smallest squares.
double TrimmedRms(const std::vector<Residual>& residuals) {
  std::vector<double> squares;
  for (const Residual& r : residuals) squares.push_back(r.distance_m * r.distance_m);
  std::sort(squares.begin(), squares.end());
  squares.resize(std::max<std::size_t>(
      1, static_cast<std::size_t>(kTrim * static_cast<double>(squares.size()))));
  double sum = 0.0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

bool EnoughOverSurface(const std::vector<Residual>& residuals) {
  const auto num = std::count_if(residuals.begin(), residuals.end(),
                                 [](const Residual& r) { return r.is_over_surface; });
  return num >= static_cast<long>(kMinPoints);
}

// Tukey's biweights of the points over the surface, 0 for the others.
std::vector<double> TukeyWeights(const std::vector<Residual>& residuals, double floor_m) {
  std::vector<double> distances_m;
  for (const Residual& r : residuals) {
    if (r.is_over_surface) distances_m.push_back(std::abs(r.distance_m));
  }
  const double cut_m = kTukey * std::max(kMadToSigma * Median(distances_m), floor_m);
  std::vector<double> weights;
  for (const Residual& r : residuals) {
    const double ratio = r.distance_m / cut_m;
    const double rest = std::max(0.0, 1 - ratio * ratio);
    weights.push_back(r.is_over_surface ? rest * rest : 0.0);
  }
  return weights;
}

// One Gauss-Newton step; returns how far it moves the points at most. Nearest points and weights
// change with every step, so that MinimizeSquares() would have no cost by which to judge it.
double Step(const std::vector<Residual>& residuals, const std::vector<double>& weights,
            Rigid3* pose) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Residual& r : residuals) center += r.x_m / static_cast<double>(residuals.size());
  double radius_m = 0.0;
  for (const Residual& r : residuals) radius_m = std::max(radius_m, (r.x_m - center).norm());
  GaussNewtonEquations<6> equations;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const Residual& r = residuals[i];
    Eigen::Matrix<double, 1, 6> row;
    row << (r.x_m - center).cross(r.direction).transpose() / radius_m, r.direction.transpose();
    const double root = std::sqrt(weights[i]);
    equations.Add<1>(root * row, Eigen::Matrix<double, 1, 1>(root * r.distance_m));
  }
  // Keeps motions still that the surface leaves open, and hardly slows the others.
  equations.AddToDiagonal(1e-9 * equations.hessian().trace());
  const auto solution = SolveDamped(equations, 0.0);
  if (!solution) return 0.0;
  const Eigen::Matrix<double, 6, 1>& motion = *solution;
  const Eigen::Vector3d turn = motion.head<3>() / radius_m;
  const double angle = std::min(turn.norm(), kMaxTurn_rad);
  const Eigen::Quaterniond rotation(turn.norm() > 0 ? Eigen::AngleAxisd(angle, turn.normalized())
                                                    : Eigen::AngleAxisd::Identity());
  const Rigid3 moved{rotation, center - rotation * center + motion.tail<3>()};
  *pose = moved * *pose;
  return angle * radius_m + motion.tail<3>().norm();
}

struct Fit {
  Rigid3 pose;
  double trimmed_rms_m = 0.0;
  bool has_converged = false;
};

Fit Iterate(const Points& points, const MeshDistance& mesh, const Rigid3& start, bool is_fine,
            int num_iterations) {
  Fit best{start, 0.0, false};
  Rigid3 pose = start;
  for (int i = 0;; ++i) {
    const std::vector<Residual> residuals = ComputeResiduals(points, pose, mesh);
    const double trimmed_rms_m = TrimmedRms(residuals);
    // The robust fit goes where its weights lead; the coarse one may overshoot and has to better.
    if (i == 0 || is_fine || trimmed_rms_m < best.trimmed_rms_m) {
      best.pose = pose;
      best.trimmed_rms_m = trimmed_rms_m;
    }
    if (i == num_iterations || best.has_converged) return best;
    const bool is_robust = is_fine && EnoughOverSurface(residuals);
    const std::vector<double> weights = is_robust
                                            ? TukeyWeights(residuals, kFloor * mesh.Diagonal_m())
                                            : std::vector<double>(residuals.size(), 1.0);
    best.has_converged = Step(residuals, weights, &pose) < kConverged * mesh.Diagonal_m();
  }
}

struct Axes {
  Eigen::Vector3d mean;
  Eigen::Matrix3d directions;  // columns, by ascending spread, right-handed
};

Axes PrincipalAxes(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance) {
  Eigen::Matrix3d directions =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  if (directions.determinant() < 0) directions.col(0) *= -1;
  return {mean, directions};
}

// The 24 turns of a cube onto itself.
std::vector<Eigen::Matrix3d> CubeRotations() {
  std::vector<Eigen::Matrix3d> rotations;
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
      for (int i = 0; i < 3; ++i) {
        rotation(order[static_cast<std::size_t>(i)], i) = (signs >> i) % 2 == 0 ? 1.0 : -1.0;
      }
      if (rotation.determinant() > 0) rotations.push_back(rotation);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return rotations;
}

std::vector<Rigid3> Starts(const Points& points, const MeshDistance& mesh, bool starts_as_is) {
  std::vector<Rigid3> starts = {Rigid3()};
  if (starts_as_is) return starts;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& x : points) mean += x / static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& x : points) covariance += (x - mean) * (x - mean).transpose();
  const Axes of_points = PrincipalAxes(mean, covariance);
  const Axes of_mesh = PrincipalAxes(mesh.Moments().mean_m, mesh.Moments().covariance_m2);
  for (const Eigen::Matrix3d& turn : CubeRotations()) {
    const Eigen::Quaterniond rotation(
        Eigen::Matrix3d(of_mesh.directions * turn * of_points.directions.transpose()));
    starts.push_back({rotation, of_mesh.mean - rotation * of_points.mean});
  }
  return starts;
}

std::vector<Fit> FitFromStarts(const Points& points, const MeshDistance& mesh, bool starts_as_is) {
  const auto better = [](const Fit& a, const Fit& b) { return a.trimmed_rms_m < b.trimmed_rms_m; };
  std::vector<Fit> coarse;
  const Points thinned = Thinned(points, kMaxCoarsePoints);
  for (const Rigid3& start : Starts(points, mesh, starts_as_is)) {
    coarse.push_back(Iterate(thinned, mesh, start, false, kCoarseIterations));
  }
  std::stable_sort(coarse.begin(), coarse.end(), better);
  std::vector<Fit> fits;
  for (std::size_t i = 0; i < std::min(coarse.size(), kNumFineStarts); ++i) {
    fits.push_back(Iterate(points, mesh, coarse[i].pose, true, kFineIterations));
  }
  std::stable_sort(fits.begin(), fits.end(), better);
  return fits;
}

void AddNotes(const std::vector<Fit>& fits, double floor_m, Alignment* alignment) {
  const Fit& best = fits.front();
  if (!best.has_converged) {
    alignment->notes.push_back(
        fmt::format("the fit still moved after {} iterations; give a start closer to the end",
                    kFineIterations));
  }
  const int num_free = AlignmentSensitivity(*alignment).NumFreeDirections();
  if (num_free > 0) {
    alignment->notes.push_back(
        fmt::format("the surface leaves {} of 6 rigid motions open (a plane, a sphere or a "
                    "cylinder has such); distances along it mean nothing",
                    num_free));
  }
  for (const Fit& fit : fits) {
    const double angle = AngularDistance(fit.pose, best.pose);
    if (angle < kOtherPose_rad || fit.trimmed_rms_m > kAlsoFits * best.trimmed_rms_m + floor_m) {
      continue;
    }
    alignment->notes.push_back(
        fmt::format("a pose turned by {:.0f} degrees fits as well; bring the shape near its place "
                    "and fit from there (--align_start as_is) to choose",
                    angle * 180 / M_PI));
    return;
  }
}

Alignment DescribeFit(const std::vector<Fit>& fits, const Corners& corners,
                      const MeshDistance& mesh) {
  Alignment alignment;
  alignment.method = AlignmentMethod::kBestFit;
  alignment.reference_from_shape = fits.front().pose;
  const std::vector<Residual> residuals =
      ComputeResiduals(corners.x_in_shape_m, fits.front().pose, mesh);
  if (!EnoughOverSurface(residuals)) {
    throw DataError(
        "the best fit brings fewer than six corners over the reference's surface; give a surface "
        "that covers the markers, or align the two by hand and give --align none");
  }
  const double floor_m = kFloor * mesh.Diagonal_m();
  const std::vector<double> weights = TukeyWeights(residuals, floor_m);
  std::vector<double> used_m;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (weights[i] <= 0) continue;
    used_m.push_back(std::abs(residuals[i].distance_m));
    alignment.equations.push_back(
        {corners.ids[i], residuals[i].x_m, residuals[i].direction, weights[i]});
  }
  alignment.description =
      fmt::format("onto the surface, {} of {} corners", used_m.size(), residuals.size());
  alignment.residual_m = ComputeStatistics(std::move(used_m));
  AddNotes(fits, floor_m, &alignment);
  return alignment;
}

}  // namespace

Alignment AlignToMesh(const MarkerShape& shape, const MeshDistance& mesh,
                      const AlignmentOptions& options) {
  if (options.method == AlignmentMethod::kNone) {
    Alignment alignment;
    alignment.description = "both frames are taken as one";
    return alignment;
  }
  if (options.method != AlignmentMethod::kAuto && options.method != AlignmentMethod::kBestFit) {
    throw InputError(
        fmt::format("--align {}: the reference is a surface and has no markers; give "
                    "best_fit or none",
                    AlignmentMethodName(options.method)));
  }
  const Corners corners = CollectCorners(shape);
  if (corners.ids.size() < kMinPoints) {
    throw DataError(
        fmt::format("{} marker corners are too few for a best fit onto a surface, "
                    "which needs {}",
                    corners.ids.size(), kMinPoints));
  }
  return DescribeFit(FitFromStarts(corners.x_in_shape_m, mesh, options.starts_as_is), corners,
                     mesh);
}

}  // namespace velamap
