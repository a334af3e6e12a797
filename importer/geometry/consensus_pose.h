// Pose of a camera by the consensus of markers whose corners are known in space.

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "importer/geometry/p3p.h"
#include "importer/geometry/quad.h"
#include "importer/geometry/rigid3.h"

namespace velamap {

struct PoseHypothesis {
  Rigid3 cam_from_space;
  double cost = 0.0;             // sum of the markers' squared errors, each at most 1
  std::vector<int> inlier_idxs;  // of the markers with an error up to 1, ascending
};

// The estimator of poses for Ransac() in ransac.h, by P3P over corners of three markers. `Markers`
// has
//   NumSampled()                     markers of which samples are drawn
//   Corner(marker_idx, corner_idx)   of such a marker: in space, and its ray (x/z, y/z)
//   Errors(cam_from_space)           of each marker on which poses are scored, 1 at the tolerance
//   NumScored()                      the number of these
//   Fit(inlier_idxs, cam_from_space) the pose fitted to some of these, from a start
template <typename Markers>
class PoseConsensus {
 public:
  using Model = Rigid3;
  using Hypothesis = PoseHypothesis;
  static constexpr int kSampleSize = 3;

  explicit PoseConsensus(const Markers& markers) : markers_(markers) {}

  std::size_t NumData() const { return markers_.NumScored(); }

  std::vector<Rigid3> Generate(std::mt19937* generator) const {
    const auto sample = SampleCorners(markers_.NumSampled(), generator);
    if (!sample) return {};
    std::array<Eigen::Vector3d, 3> x_in_space;
    std::array<Eigen::Vector2d, 3> rays;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [marker_idx, corner_idx] = (*sample)[i];
      std::tie(x_in_space[i], rays[i]) = markers_.Corner(marker_idx, corner_idx);
    }
    return SolveP3P(x_in_space, rays);
  }

  PoseHypothesis Score(const Rigid3& cam_from_space) const {
    PoseHypothesis hypothesis{cam_from_space, 0.0, {}};
    const std::vector<double> errors = markers_.Errors(cam_from_space);
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const bool is_inlier = errors[i] <= 1.0;
      hypothesis.cost += is_inlier ? errors[i] * errors[i] : 1.0;
      if (is_inlier) hypothesis.inlier_idxs.push_back(static_cast<int>(i));
    }
    return hypothesis;
  }

  PoseHypothesis Refine(const PoseHypothesis& hypothesis) const {
    if (hypothesis.inlier_idxs.empty()) return hypothesis;
    return Score(markers_.Fit(hypothesis.inlier_idxs, hypothesis.cam_from_space));
  }

 private:
  const Markers& markers_;
};

// Corners of one marker in space, in any frame and unit, and as rays (x/z, y/z) in the cam frame.
struct MarkerRays {
  std::array<Eigen::Vector3d, kNumCorners> corners_in_space;
  QuadCorners rays;
};

// The smallest number of markers that support a pose.
inline constexpr std::size_t kMinConsensus = 4;

// RANSAC, then Levenberg-Marquardt on all corners of the inliers: the markers whose corners all
// project to within the mean length of the marker's sides in the image. Returns nothing unless at
// least four markers and half of all are inliers. The same input gives the same result.
std::optional<PoseHypothesis> FindConsensusPose(std::vector<MarkerRays> markers);

}  // namespace velamap
