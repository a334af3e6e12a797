#include "reconstruct/thesis/frame_alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "importer/geometry/alignment.h"
#include "importer/geometry/triple_pose.h"

namespace velamap {
namespace {

constexpr int kMinMarkersForCenters = 4;
constexpr int kMaxRefinements = 10;

struct SharedMarker {
  int marker_id;
  const FrameMarker* in_frame;
  const MarkerPoints* in_shape;
  double max_error_m;
};

struct Score {
  double cost = std::numeric_limits<double>::max();  // MSAC: sum of min(error^2 / max^2, 1)
  std::vector<int> inlier_idxs;
};

std::vector<SharedMarker> FindShared(const FrameShape& frame, const ShapePoints& shape,
                                     const Layout& layout, double max_error_m) {
  std::vector<SharedMarker> shared;
  for (const FrameMarker& marker : frame.markers) {
    const auto it = shape.find(marker.marker_id);
    if (it == shape.end()) continue;
    const double own_max_error_m =
        std::max(MarkerLength(layout, marker.marker_id), 3 * marker.depth_sigma_m);
    shared.push_back(
        {marker.marker_id, &marker, &it->second, max_error_m > 0 ? max_error_m : own_max_error_m});
  }
  return shared;
}

// The shared markers of a frame and the shape, compared by centres or by all points.
class AlignmentProblem {
 public:
  explicit AlignmentProblem(std::vector<SharedMarker> shared) : shared_(std::move(shared)) {
    std::vector<Eigen::Vector3d> centers;
    for (const SharedMarker& marker : shared_) centers.push_back((*marker.in_shape)[0]);
    use_centers_ = NumMarkers() >= kMinMarkersForCenters && HasSpread(centers);
  }

  int NumMarkers() const { return static_cast<int>(shared_.size()); }
  bool UseCenters() const { return use_centers_; }
  const SharedMarker& Marker(int idx) const { return shared_[static_cast<std::size_t>(idx)]; }

  Rigid3 FromCenters(const std::vector<int>& idxs) const {
    std::vector<Eigen::Vector3d> x_in_cam, x_in_shape;
    for (const int idx : idxs) {
      x_in_cam.push_back(Marker(idx).in_frame->x_in_cam.front()[0]);
      x_in_shape.push_back((*Marker(idx).in_shape)[0]);
    }
    return EstimateRigid3(x_in_cam, x_in_shape);
  }

  Rigid3 FromMarker(int idx, const MarkerPoints& x_in_cam) const {
    const MarkerPoints& x_in_shape = *Marker(idx).in_shape;
    return EstimateRigid3({x_in_cam.begin(), x_in_cam.end()},
                          {x_in_shape.begin(), x_in_shape.end()});
  }

  Rigid3 Refine(const std::vector<int>& idxs, const Rigid3& shape_from_cam) const {
    if (use_centers_) {
      std::vector<Eigen::Vector3d> centers;
      for (const int idx : idxs) centers.push_back((*Marker(idx).in_shape)[0]);
      if (HasSpread(centers)) return FromCenters(idxs);
    }
    std::vector<Eigen::Vector3d> x_in_cam, x_in_shape;
    for (const int idx : idxs) {
      const SharedMarker& marker = Marker(idx);
      const MarkerPoints& points = marker.in_frame->x_in_cam[static_cast<std::size_t>(
          BestSolution(*marker.in_frame, shape_from_cam, *marker.in_shape))];
      x_in_cam.insert(x_in_cam.end(), points.begin(), points.end());
      x_in_shape.insert(x_in_shape.end(), marker.in_shape->begin(), marker.in_shape->end());
    }
    return EstimateRigid3(x_in_cam, x_in_shape);
  }

  double Error(int idx, const Rigid3& shape_from_cam) const {
    const SharedMarker& marker = Marker(idx);
    if (use_centers_) {
      return (shape_from_cam * marker.in_frame->x_in_cam.front()[0] - (*marker.in_shape)[0]).norm();
    }
    double error = std::numeric_limits<double>::max();
    for (const MarkerPoints& x_in_cam : marker.in_frame->x_in_cam) {
      error = std::min(error, RmsDistance(Transform(shape_from_cam, x_in_cam), *marker.in_shape));
    }
    return error;
  }

  Score Evaluate(const Rigid3& shape_from_cam) const {
    Score score{0.0, {}};
    for (int idx = 0; idx < NumMarkers(); ++idx) {
      const double relative = Error(idx, shape_from_cam) / Marker(idx).max_error_m;
      score.cost += std::min(relative * relative, 1.0);
      if (relative <= 1.0) score.inlier_idxs.push_back(idx);
    }
    return score;
  }

 private:
  std::vector<SharedMarker> shared_;
  bool use_centers_ = false;
};

std::vector<Rigid3> CenterHypotheses(const AlignmentProblem& problem, int max_num_trials,
                                     std::uint32_t seed) {
  std::mt19937 generator(seed);
  const auto draw = [&] {
    return static_cast<int>(
        RandomIndex(&generator, static_cast<std::size_t>(problem.NumMarkers())));
  };
  std::vector<Rigid3> hypotheses;
  for (int trial = 0; trial < max_num_trials; ++trial) {
    const int a = draw(), b = draw(), c = draw();
    if (a == b || b == c || a == c) continue;
    const std::vector<Eigen::Vector3d> centers = {(*problem.Marker(a).in_shape)[0],
                                                  (*problem.Marker(b).in_shape)[0],
                                                  (*problem.Marker(c).in_shape)[0]};
    if (HasSpread(centers)) hypotheses.push_back(problem.FromCenters({a, b, c}));
  }
  return hypotheses;
}

std::vector<Rigid3> CornerHypotheses(const AlignmentProblem& problem) {
  std::vector<Rigid3> hypotheses;
  for (int idx = 0; idx < problem.NumMarkers(); ++idx) {
    for (const MarkerPoints& x_in_cam : problem.Marker(idx).in_frame->x_in_cam) {
      hypotheses.push_back(problem.FromMarker(idx, x_in_cam));
    }
  }
  return hypotheses;
}

}  // namespace

int BestSolution(const FrameMarker& marker, const Rigid3& shape_from_cam,
                 const MarkerPoints& x_in_shape) {
  int best = 0;
  double best_distance = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < marker.x_in_cam.size(); ++i) {
    const double distance = RmsDistance(Transform(shape_from_cam, marker.x_in_cam[i]), x_in_shape);
    if (distance < best_distance) {
      best_distance = distance;
      best = static_cast<int>(i);
    }
  }
  return best;
}

std::optional<FrameAlignment> AlignFrame(const FrameShape& frame, const ShapePoints& shape,
                                         const Layout& layout,
                                         const FrameAlignmentOptions& options) {
  const AlignmentProblem problem(FindShared(frame, shape, layout, options.ransac_max_error_m));
  if (problem.NumMarkers() < options.min_num_inliers) return std::nullopt;

  const std::vector<Rigid3> hypotheses =
      problem.UseCenters() ? CenterHypotheses(problem, options.max_num_trials, options.random_seed)
                           : CornerHypotheses(problem);
  Rigid3 best;
  Score best_score;
  for (const Rigid3& shape_from_cam : hypotheses) {
    Score score = problem.Evaluate(shape_from_cam);
    if (score.cost < best_score.cost) {
      best = shape_from_cam;
      best_score = std::move(score);
    }
  }
  const std::size_t min_num_inliers =
      static_cast<std::size_t>(std::max(options.min_num_inliers, problem.UseCenters() ? 3 : 1));
  if (best_score.inlier_idxs.size() < min_num_inliers) return std::nullopt;
  for (int i = 0; i < kMaxRefinements; ++i) {
    const Rigid3 refined = problem.Refine(best_score.inlier_idxs, best);
    Score score = problem.Evaluate(refined);
    if (!(score.cost < best_score.cost) || score.inlier_idxs.size() < min_num_inliers) break;
    best = refined;
    best_score = std::move(score);
  }

  FrameAlignment alignment;
  alignment.shape_from_cam = best;
  double sum = 0.0;
  std::size_t next_inlier = 0;
  for (int idx = 0; idx < problem.NumMarkers(); ++idx) {
    const bool is_inlier =
        next_inlier < best_score.inlier_idxs.size() && best_score.inlier_idxs[next_inlier] == idx;
    if (!is_inlier) {
      alignment.outlier_ids.push_back(problem.Marker(idx).marker_id);
      continue;
    }
    ++next_inlier;
    alignment.inlier_ids.push_back(problem.Marker(idx).marker_id);
    const double error = problem.Error(idx, best);
    sum += error * error;
  }
  alignment.rms_error_m = std::sqrt(sum / static_cast<double>(alignment.inlier_ids.size()));
  return alignment;
}

}  // namespace velamap
