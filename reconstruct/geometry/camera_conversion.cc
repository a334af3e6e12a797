#include "reconstruct/geometry/camera_conversion.h"

#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <Eigen/Geometry>

#include "importer/camera/camera_projection.h"

namespace velamap {
namespace {

constexpr int kStride = 4;

// The error of one ray, px.
class RayError {
 public:
  RayError(CameraModel model, const Eigen::Vector2d& ray, const Eigen::Vector2d& x_px)
      : model_(model), ray_(ray), x_px_(x_px) {}

  template <typename T>
  bool operator()(T const* const* parameters, T* residuals) const {
    const Eigen::Matrix<T, 2, 1> projected =
        ImageFromRay<T, T>(model_, parameters[0], Eigen::Matrix<T, 2, 1>(ray_.cast<T>()));
    residuals[0] = projected.x() - x_px_.x();
    residuals[1] = projected.y() - x_px_.y();
    return true;
  }

 private:
  CameraModel model_;
  Eigen::Vector2d ray_, x_px_;
};

Camera StartOf(const Camera& camera, CameraModel model) {
  const std::size_t center = NumFocalLengths(camera.model);
  Camera result{model, camera.width_px, camera.height_px, {}};
  result.params.assign(NumFocalLengths(model), MeanFocalLength(camera));
  result.params.push_back(camera.params[center]);
  result.params.push_back(camera.params[center + 1]);
  result.params.resize(static_cast<std::size_t>(NumCameraParams(model)), 0.0);
  return result;
}

}  // namespace

Camera ConvertCamera(const Camera& camera, CameraModel model) {
  if (camera.model == model) return camera;
  constexpr int kNumColumns = 17, kNumRows = 11;
  constexpr double kExact_px = 1e-6;
  Camera result = StartOf(camera, model);
  ceres::Problem problem;
  for (int row = 0; row < kNumRows; ++row) {
    for (int column = 0; column < kNumColumns; ++column) {
      const Eigen::Vector2d x_px(camera.width_px * (column + 0.5) / kNumColumns,
                                 camera.height_px * (row + 0.5) / kNumRows);
      const auto ray = CamFromImage(camera, x_px);
      if (!ray) continue;
      const auto back_px = ImageFromCam(camera, ray->homogeneous());
      if (!back_px || (*back_px - x_px).norm() > kExact_px) continue;
      auto* error = new ceres::DynamicAutoDiffCostFunction<RayError, kStride>(
          new RayError(model, *ray, x_px));
      error->AddParameterBlock(static_cast<int>(result.params.size()));
      error->SetNumResiduals(2);
      problem.AddResidualBlock(error, nullptr, result.params.data());
    }
  }
  if (problem.NumResidualBlocks() == 0) return result;
  if (model == CameraModel::kFullOpenCV) {
    // Numerator and denominator can compensate for each other.
    problem.SetManifold(result.params.data(),
                        new ceres::SubsetManifold(static_cast<int>(result.params.size()),
                                                  {kBeginOfDenominator, kBeginOfDenominator + 1,
                                                   kBeginOfDenominator + 2}));
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-16;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return result;
}

}  // namespace velamap
