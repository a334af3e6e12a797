#include "reconstruct/colmap/warm_start.h"

#include <vector>

#include "importer/geometry/alignment.h"
#include "importer/geometry/pose_refinement.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/reprojection.h"

namespace velamap {
namespace {

constexpr std::size_t kMinCornersOfImage = 4;

std::vector<RayObservation> ObservationsOf(const Model& model, const ModelImage& image) {
  std::vector<RayObservation> observations;
  for (const SeenPoint& point : SeenPointsOf(model, image)) {
    const auto ray = CamFromImage(model.cameras.at(image.camera_id), point.x_in_image_px);
    if (ray) observations.push_back({point.x_in_world, *ray});
  }
  return observations;
}

// The seed's pose is accurate to some pixels, so least squares finds the right minimum.
Rigid3 Resect(const Model& model, const ModelImage& image) {
  constexpr double kLossRay = 1e-3;  // 2 px of a lens with a focal length of 2000 px
  const std::vector<RayObservation> observations = ObservationsOf(model, image);
  if (observations.size() < kMinCornersOfImage) return image.cam_from_world;
  return RefinePose(observations, image.cam_from_world, CauchyLoss{kLossRay * kLossRay});
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
      image.cam_from_world = Resect(*seed, image);
    }
  }
  UpdatePointErrors(seed);
  return start;
}

}  // namespace velamap
