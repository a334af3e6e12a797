#include "importer/geometry/p3p.h"

#include <opencv2/calib3d.hpp>

#include "importer/base/ids.h"
#include "importer/geometry/opencv_pose.h"
#include "importer/geometry/ransac.h"

namespace velamap {

std::vector<Rigid3> SolveP3P(const std::array<Eigen::Vector3d, 3>& x_in_world,
                             const std::array<Eigen::Vector2d, 3>& rays) {
  std::vector<cv::Point3d> in_world;
  std::vector<cv::Point2d> in_image;
  for (std::size_t i = 0; i < 3; ++i) {
    in_world.emplace_back(x_in_world[i].x(), x_in_world[i].y(), x_in_world[i].z());
    in_image.emplace_back(rays[i].x(), rays[i].y());
  }
  std::vector<cv::Mat> rotation_vectors, translations;
  cv::solveP3P(in_world, in_image, cv::Matx33d::eye(), cv::noArray(), rotation_vectors,
               translations, cv::SOLVEPNP_AP3P);
  std::vector<Rigid3> poses;
  for (std::size_t i = 0; i < rotation_vectors.size(); ++i) {
    if (!cv::checkRange(rotation_vectors[i]) || !cv::checkRange(translations[i])) continue;
    poses.push_back(RigidFromOpenCV(rotation_vectors[i], translations[i]));
  }
  return poses;
}

std::optional<std::array<SampledCorner, 3>> SampleCorners(std::size_t num_markers,
                                                          std::mt19937* generator) {
  std::array<SampledCorner, 3> corners;
  for (SampledCorner& corner : corners) {
    corner.marker_idx = RandomIndex(generator, num_markers);
    corner.corner_idx = RandomIndex(generator, kNumCorners);
  }
  const auto& [a, b, c] = corners;
  if (a.marker_idx == b.marker_idx || b.marker_idx == c.marker_idx ||
      a.marker_idx == c.marker_idx) {
    return std::nullopt;
  }
  return corners;
}

}  // namespace velamap
