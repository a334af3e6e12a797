#include "importer/geometry/triple_pose.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/calib3d.hpp>

namespace velamap {
namespace {

constexpr double kMissRate = 1e-9;

Eigen::Vector3d FromOpenCV(const cv::Mat& vector) {
  return {vector.at<double>(0), vector.at<double>(1), vector.at<double>(2)};
}

}  // namespace

std::vector<TriplePose> PosesOfTriple(const std::array<Eigen::Vector3d, 3>& x_in_space,
                                      const std::array<Eigen::Vector2d, 3>& rays) {
  std::vector<cv::Point3d> in_space;
  std::vector<cv::Point2d> in_image;
  for (std::size_t i = 0; i < 3; ++i) {
    in_space.emplace_back(x_in_space[i].x(), x_in_space[i].y(), x_in_space[i].z());
    in_image.emplace_back(rays[i].x(), rays[i].y());
  }
  std::vector<cv::Mat> rotation_vectors, translations;
  cv::solveP3P(in_space, in_image, cv::Matx33d::eye(), cv::noArray(), rotation_vectors,
               translations, cv::SOLVEPNP_AP3P);
  std::vector<TriplePose> poses;
  for (std::size_t i = 0; i < rotation_vectors.size(); ++i) {
    const TriplePose pose{FromOpenCV(rotation_vectors[i]), FromOpenCV(translations[i])};
    if (pose.rotation_vector.allFinite() && pose.translation.allFinite()) poses.push_back(pose);
  }
  return poses;
}

int NumTriples(double agreeing_part, int min, int max) {
  const double log_miss = std::log1p(-std::pow(agreeing_part, 3));
  if (log_miss * max >= std::log(kMissRate)) return max;
  return std::max(min, static_cast<int>(std::log(kMissRate) / log_miss) + 1);
}

std::size_t RandomIndex(std::mt19937* generator, std::size_t size) {
  return static_cast<std::size_t>(
      (static_cast<std::uint64_t>((*generator)()) * static_cast<std::uint64_t>(size)) >> 32);
}

}  // namespace velamap
