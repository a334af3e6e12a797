#include "reconstruct/colmap/warm_start.h"

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>

#include "importer/geometry/alignment.h"
#include "importer/geometry/pose_step.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/reprojection.h"

namespace velamap {
namespace {

constexpr std::size_t kMinCorners = 4;

// A corner where the undistorted ray of its observation meets the plane z = 1, and its place.
struct ResectedCorner {
  Eigen::Vector2d ray;
  Eigen::Vector3d x_in_world;
};

std::vector<ResectedCorner> CornersOf(const Model& model, const ModelImage& image) {
  std::vector<ResectedCorner> corners;
  for (const Point2D& point : image.points2D) {
    if (point.point3D_id == kInvalidPoint3DId) continue;
    const auto ray = CamFromImage(model.cameras.at(image.camera_id), point.x_in_image_px);
    if (ray) corners.push_back({*ray, model.points3D.at(point.point3D_id).x_in_world});
  }
  return corners;
}

// Of a Cauchy loss, as a fraction of the focal length: 2 px of a lens of 2000 px.
constexpr double kLossRay = 1e-3;

double Cost(const std::vector<ResectedCorner>& corners, const Rigid3& cam_from_world) {
  double cost = 0.0;
  for (const ResectedCorner& corner : corners) {
    const Eigen::Vector3d x = cam_from_world * corner.x_in_world;
    if (!(x.z() > 0)) return std::numeric_limits<double>::infinity();
    cost += std::log1p((x.hnormalized() - corner.ray).squaredNorm() / (kLossRay * kLossRay));
  }
  return cost;
}

// One Gauss-Newton step.
Rigid3 Step(const std::vector<ResectedCorner>& corners, const Rigid3& cam_from_world) {
  Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();
  PoseStep gradient = PoseStep::Zero();
  for (const ResectedCorner& corner : corners) {
    const Eigen::Vector3d rotated = cam_from_world.rotation * corner.x_in_world;
    const Eigen::Vector3d x = rotated + cam_from_world.translation;
    const Eigen::Matrix<double, 2, 6> jacobian = RayFromPoseStep(rotated, x);
    const Eigen::Vector2d residual = x.hnormalized() - corner.ray;
    const double weight = 1 / (1 + residual.squaredNorm() / (kLossRay * kLossRay));
    hessian += weight * jacobian.transpose() * jacobian;
    gradient += weight * jacobian.transpose() * residual;
  }
  return Moved(cam_from_world, -hessian.ldlt().solve(gradient));
}

// The seed's pose is good to some pixels, so that steps need no damping; one that does not help
// ends the search.
Rigid3 Resect(const std::vector<ResectedCorner>& corners, Rigid3 cam_from_world) {
  constexpr int kMaxIterations = 10;
  constexpr double kMinGain = 1e-6;
  if (corners.size() < kMinCorners) return cam_from_world;
  double cost = Cost(corners, cam_from_world);
  for (int i = 0; i < kMaxIterations; ++i) {
    const Rigid3 stepped = Step(corners, cam_from_world);
    const double cost_after = Cost(corners, stepped);
    if (!(cost_after < cost)) break;
    const bool small = cost - cost_after < kMinGain * cost;
    cam_from_world = stepped;
    cost = cost_after;
    if (small) break;
  }
  return cam_from_world;
}

}  // namespace

WarmStart StartFromAdjusted(const Model& adjusted, Model* seed) {
  constexpr double kMinShare = 0.5;
  WarmStart start;
  std::vector<Eigen::Vector3d> x_in_adjusted, x_in_seed;
  for (const auto& [point3D_id, point] : seed->points3D) {
    const auto known = adjusted.points3D.find(point3D_id);
    if (known == adjusted.points3D.end()) continue;
    x_in_adjusted.push_back(known->second.x_in_world);
    x_in_seed.push_back(point.x_in_world);
  }
  const double num_points = static_cast<double>(seed->points3D.size());
  if (static_cast<double>(x_in_seed.size()) < kMinShare * num_points || !HasSpread(x_in_seed)) {
    return start;
  }
  Model moved = adjusted;
  TransformModel(EstimateSim3(x_in_adjusted, x_in_seed), &moved);
  for (auto& [point3D_id, point] : seed->points3D) {
    const auto known = moved.points3D.find(point3D_id);
    if (known == moved.points3D.end()) continue;
    point.x_in_world = known->second.x_in_world;
    ++start.num_points;
  }
  for (ModelImage& image : seed->images) {
    const ModelImage* known = moved.FindImage(image.image_id);
    if (known != nullptr) {
      image.cam_from_world = known->cam_from_world;
      ++start.num_images;
    } else {
      image.cam_from_world = Resect(CornersOf(*seed, image), image.cam_from_world);
    }
  }
  UpdatePointErrors(seed);
  return start;
}

}  // namespace velamap
