// Pose of a camera by nonlinear least squares on rays.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "importer/geometry/least_squares.h"
#include "importer/geometry/pose_step.h"

namespace velamap {

// A point in the world and its undistorted ray (x/z, y/z) in the cam frame.
struct RayObservation {
  Eigen::Vector3d x_in_world;
  Eigen::Vector2d ray;
};

// Residuals are projected minus observed rays; a pose with a point behind the camera is rejected.
template <typename Loss>
struct RayPoseProblem : LeastSquaresProblem<6> {
  using Parameters = Rigid3;  // cam_from_world

  const std::vector<RayObservation>& observations;
  Loss loss;

  RayPoseProblem(const std::vector<RayObservation>& all, const Loss& rho)
      : observations(all), loss(rho) {}

  void Evaluate(const Rigid3& cam_from_world, bool, Equations* equations) const {
    *equations = {};
    const Eigen::Matrix3d rotation = cam_from_world.rotation.toRotationMatrix();
    for (const RayObservation& observation : observations) {
      const Eigen::Vector3d rotated = rotation * observation.x_in_world;
      const Eigen::Vector3d x_in_cam = rotated + cam_from_world.translation;
      if (!(x_in_cam.z() > 0)) return equations->Reject();
      const Eigen::Vector2d residual = x_in_cam.hnormalized() - observation.ray;
      equations->Add(ByPoseStep(RayByPoint(x_in_cam), rotated), residual, loss);
    }
  }

  Rigid3 Plus(const Rigid3& pose, const Step& step) const { return PlusPose(pose, step); }
  // Rotations and translations converge together; rad is a unit that all scenes share.
  double StepSize(const Step& step, const Equations&) const { return step.head<3>().norm(); }
};

// Levenberg-Marquardt from `cam_from_world`, which is returned unchanged if a point lies behind
// that camera. OpenCV's solvePnPRefineLM does the same without a loss and takes 20 times as long.
template <typename Loss = TrivialLoss>
Rigid3 RefinePose(const std::vector<RayObservation>& observations, Rigid3 cam_from_world,
                  const Loss& loss = {}) {
  LeastSquaresOptions options;
  options.initial_damping = 1e-6;
  options.min_step = 1e-10;
  GaussNewtonEquations<6> equations;
  MinimizeSquares(options, RayPoseProblem<Loss>(observations, loss), &cam_from_world, &equations);
  return cam_from_world;
}

}  // namespace velamap
