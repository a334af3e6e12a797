#include "reconstruct/adjust/calibration_score.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "importer/base/error.h"
#include "importer/camera/camera_projection.h"
#include "importer/geometry/symmetric_eigen.h"
#include "reconstruct/correlation/corner_correlation.h"
#include "reconstruct/geometry/covariance_update.h"
#include "reconstruct/problem/marker_uncertainty.h"

namespace velamap {
namespace {

// Columns of the warps. Focal length first, then aspect and principal point, then distortion.
constexpr int kFocal = 0, kFirstDistortion = 4, kNumWarps = 8;
using WarpMatrix = Eigen::Matrix<double, 2, kNumWarps>;

// If the adjustment absorbs nearly all of a warp, the warp has the same effect as another shape,
// and the rest is rounding error. A warp needs at least this share of its information.
constexpr double kMinShareOfInformation = 1e-6;

// Displacements, px, at (u, v): distance from the principal point in half diagonals of the image.
WarpMatrix WarpsAt(double u, double v) {
  const double r2 = u * u + v * v;
  WarpMatrix warps;
  warps << u, u, 1, 0, r2 * u, r2 * r2 * u, 2 * u * v, r2 + 2 * u * u,  //
      v, -v, 0, 1, r2 * v, r2 * r2 * v, r2 + 2 * v * v, 2 * u * v;
  return warps;
}

Eigen::Vector2d PrincipalPoint(const Camera& camera) {
  const std::size_t first = NumFocalLengths(camera.model);
  return {camera.params[first], camera.params[first + 1]};
}

double HalfDiagonal(const Camera& camera) {
  return 0.5 * std::hypot(camera.width_px, camera.height_px);
}

// Derivatives of all residuals with respect to the warps of one camera, evaluated at the projected
// corners. At the detected corners, the warps would contain their errors, and the residuals would
// correlate with the part of a warp that the adjustment does not absorb.
RowMajorMatrix DesignMatrix(const Model& model, const MarkerProblem& problem, CameraId camera_id,
                            const RowMajorMatrix& residuals) {
  RowMajorMatrix residuals_px = residuals;
  ResidualsToPixels(problem, &residuals_px);
  const Camera& camera = model.cameras.at(camera_id);
  std::map<ImageId, const ModelImage*> images;
  for (const ModelImage& image : model.images) {
    if (image.camera_id == camera_id) images[image.image_id] = &image;
  }
  RowMajorMatrix design = RowMajorMatrix::Zero(residuals.rows(), kNumWarps);
  for (std::size_t i = 0; i < problem.corners.size(); ++i) {
    const TrackElement& element = problem.corners[i].second;
    const auto image = images.find(element.image_id);
    if (image == images.end()) continue;
    const Eigen::Index row = 2 * static_cast<Eigen::Index>(i);
    const Eigen::Vector2d found_px = image->second->points2D.at(element.point2D_idx).x_in_image_px;
    const Eigen::Vector2d by_model_px = found_px + residuals_px.block<2, 1>(row, 0);
    const Eigen::Vector2d offset = (by_model_px - PrincipalPoint(camera)) / HalfDiagonal(camera);
    design.middleRows<2>(row) = WarpsAt(offset.x(), offset.y());
  }
  PixelsToResiduals(problem, &design);
  return design;
}

RowMajorMatrix AllResiduals(const MarkerProblem& problem) {
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = problem.ResidualsWithoutBars();
  std::vector<double> residuals;
  VELAMAP_CHECK(problem.ceres->Evaluate(options, nullptr, &residuals, nullptr, nullptr));
  return Eigen::Map<const Eigen::MatrixXd>(residuals.data(),
                                           static_cast<Eigen::Index>(residuals.size()), 1);
}

// The least-squares fit of columns to residuals: changes, their covariance, decrease of the sum of
// squares. Columns are scaled to equal length first; combinations without information are left out.
struct ChangeFit {
  Eigen::VectorXd changes;
  Eigen::MatrixXd covariance;
  double chi_squared = 0.0;
  int rank = 0;
};

ChangeFit FitChanges(const Eigen::MatrixXd& information, const Eigen::MatrixXd& full_information,
                     const Eigen::VectorXd& gradient) {
  const Eigen::VectorXd scales = full_information.diagonal().cwiseSqrt().cwiseMax(1e-300);
  const Eigen::MatrixXd scaled =
      scales.cwiseInverse().asDiagonal() * information * scales.cwiseInverse().asDiagonal();
  const SymmetricEigen eigen = DecomposeSymmetric(scaled);
  ChangeFit fit;
  fit.covariance = Eigen::MatrixXd::Zero(information.rows(), information.rows());
  for (Eigen::Index i = 0; i < scaled.rows(); ++i) {
    if (!(eigen.values[i] > kMinShareOfInformation)) continue;
    const Eigen::VectorXd direction = eigen.vectors.col(i).cwiseQuotient(scales);
    fit.covariance += direction * direction.transpose() / eigen.values[i];
    ++fit.rank;
  }
  fit.changes = -fit.covariance * gradient;
  fit.chi_squared = gradient.dot(fit.covariance * gradient);
  return fit;
}

void SetMovement(const MarkerState& state, const Eigen::VectorXd& movement,
                 CalibrationEvidence* evidence) {
  const std::vector<Eigen::Vector3d> positions = Positions(state);
  const Eigen::VectorXd scale_gradient = ScaleGradient(positions);
  evidence->scale_change = scale_gradient.dot(movement);
  const Eigen::MatrixXd motions = RigidMotions(positions);
  const Eigen::VectorXd rest = movement - motions * (motions.transpose() * movement);
  evidence->shape_change_m = rest.norm() / std::sqrt(static_cast<double>(positions.size()));
}

CalibrationEvidence TestCamera(const Model& model, CameraId camera_id,
                               const MarkerLinearization& linearization,
                               const RowMajorMatrix& residuals) {
  const auto& [state, problem, jacobian, covariance] = linearization;
  const RowMajorMatrix design = DesignMatrix(model, problem, camera_id, residuals);
  const RowMajorMatrix left = ErrorsLeft(jacobian, covariance, design);
  const Eigen::MatrixXd full_information = design.transpose() * design;
  const Eigen::MatrixXd information = design.transpose() * left;
  const Eigen::VectorXd gradient = left.transpose() * residuals;
  const ChangeFit fit = FitChanges(information, full_information, gradient);
  CalibrationEvidence evidence;
  evidence.num_changes = fit.rank;
  evidence.chi_squared = fit.chi_squared;
  if (fit.rank == 0) return evidence;
  const auto share_of = [&](int first, int count) {
    return FitChanges(information.block(first, first, count, count),
                      full_information.block(first, first, count, count),
                      gradient.segment(first, count))
               .chi_squared /
           std::max(fit.chi_squared, 1e-300);
  };
  evidence.focal_share = share_of(kFocal, 1);
  evidence.distortion_share = share_of(kFirstDistortion, kNumWarps - kFirstDistortion);
  RowMajorMatrix explained_px = left * fit.changes;
  ResidualsToPixels(problem, &explained_px);
  const auto num_corners = static_cast<Eigen::Index>(problem.corners.size());
  evidence.systematic_px = std::sqrt(explained_px.topRows(2 * num_corners).squaredNorm() /
                                     static_cast<double>(num_corners));
  const double half_diagonal_px = HalfDiagonal(model.cameras.at(camera_id));
  evidence.focal_change = fit.changes[kFocal] / half_diagonal_px;
  evidence.focal_sigma = std::sqrt(fit.covariance(kFocal, kFocal)) / half_diagonal_px;
  const RowMajorMatrix errors = design * fit.changes;
  SetMovement(state, -LeastSquaresStep(jacobian, covariance, errors).of_points.col(0), &evidence);
  return evidence;
}

}  // namespace

CalibrationEvidence TestCalibration(const Model& model, const MarkerLinearization& linearization) {
  const RowMajorMatrix residuals = AllResiduals(linearization.problem);
  CalibrationEvidence strongest;
  for (const auto& [camera_id, camera] : model.cameras) {
    const CalibrationEvidence evidence = TestCamera(model, camera_id, linearization, residuals);
    if (evidence.chi_squared > strongest.chi_squared) strongest = evidence;
  }
  return strongest;
}

}  // namespace velamap
