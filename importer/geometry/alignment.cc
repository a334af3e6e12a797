#include "importer/geometry/alignment.h"

#include <Eigen/SVD>

#include "importer/base/error.h"
#include "importer/geometry/principal_axes.h"

namespace velamap {
namespace {

struct Moments {
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_b = Eigen::Vector3d::Zero();
  double variance_a = 0.0;
  Eigen::Matrix3d covariance_ba = Eigen::Matrix3d::Zero();
};

Moments ComputeMoments(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b,
                       const std::vector<double>& weights) {
  VELAMAP_CHECK(a.size() == b.size() && a.size() >= 3);
  VELAMAP_CHECK(weights.empty() || weights.size() == a.size());
  const auto weight = [&weights](std::size_t i) { return weights.empty() ? 1.0 : weights[i]; };
  Moments moments;
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += weight(i);
    moments.mean_a += weight(i) * a[i];
    moments.mean_b += weight(i) * b[i];
  }
  VELAMAP_CHECK(sum > 0);
  moments.mean_a /= sum;
  moments.mean_b /= sum;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector3d centred_a = a[i] - moments.mean_a;
    moments.variance_a += weight(i) * centred_a.squaredNorm() / sum;
    moments.covariance_ba += weight(i) * (b[i] - moments.mean_b) * centred_a.transpose() / sum;
  }
  return moments;
}

struct RotationAndTrace {
  Eigen::Matrix3d rotation;
  double trace;  // of D S in Umeyama's equation 42, the numerator of the scale
};

RotationAndTrace SolveRotation(const Eigen::Matrix3d& covariance_ba) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance_ba,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) signs.z() = -1;
  return {svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose(),
          svd.singularValues().dot(signs)};
}

}  // namespace

Rigid3 EstimateRigid3(const std::vector<Eigen::Vector3d>& x_in_a,
                      const std::vector<Eigen::Vector3d>& x_in_b,
                      const std::vector<double>& weights) {
  const Moments moments = ComputeMoments(x_in_a, x_in_b, weights);
  const Eigen::Matrix3d rotation = SolveRotation(moments.covariance_ba).rotation;
  return {Eigen::Quaterniond(rotation).normalized(), moments.mean_b - rotation * moments.mean_a};
}

Sim3 EstimateSim3(const std::vector<Eigen::Vector3d>& x_in_a,
                  const std::vector<Eigen::Vector3d>& x_in_b) {
  const Moments moments = ComputeMoments(x_in_a, x_in_b, {});
  VELAMAP_CHECK(moments.variance_a > 0);
  const RotationAndTrace solution = SolveRotation(moments.covariance_ba);
  Sim3 b_from_a;
  b_from_a.scale = solution.trace / moments.variance_a;
  b_from_a.rotation = Eigen::Quaterniond(solution.rotation).normalized();
  b_from_a.translation = moments.mean_b - b_from_a.scale * (solution.rotation * moments.mean_a);
  return b_from_a;
}

bool HasSpread(const std::vector<Eigen::Vector3d>& points) {
  constexpr double kMinRatio = 0.05;
  if (points.size() < 3) return false;
  const Eigen::Vector3d sums = ComputePrincipalAxes(points).sums_of_squares;
  return sums[1] >= kMinRatio * kMinRatio * sums[2] && sums[2] > 0;
}

}  // namespace velamap
