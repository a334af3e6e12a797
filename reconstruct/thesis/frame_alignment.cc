#include "reconstruct/thesis/frame_alignment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "importer/geometry/alignment.h"
#include "importer/geometry/ransac.h"

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

struct AlignmentHypothesis {
  Rigid3 shape_from_cam;
  double cost = 0.0;  // MSAC: sum of min(error^2 / max^2, 1)
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

// The pose solution of a marker that fits its position in the shape best.
const MarkerPoints& BestSolution(const SharedMarker& marker, const Rigid3& shape_from_cam) {
  const auto distance_m = [&](const MarkerPoints& x_in_cam) {
    return RmsDistance(Transform(shape_from_cam, x_in_cam), *marker.in_shape);
  };
  const std::vector<MarkerPoints>& solutions = marker.in_frame->x_in_cam;
  return *std::min_element(
      solutions.begin(), solutions.end(),
      [&](const MarkerPoints& a, const MarkerPoints& b) { return distance_m(a) < distance_m(b); });
}

// The shared markers of a frame and the shape, compared by centres or by all points (ransac.h).
class AlignmentProblem {
 public:
  using Model = Rigid3;
  using Hypothesis = AlignmentHypothesis;
  static constexpr int kSampleSize = 3;

  AlignmentProblem(std::vector<SharedMarker> shared, int min_num_inliers)
      : shared_(std::move(shared)) {
    std::vector<Eigen::Vector3d> centers;
    for (const SharedMarker& marker : shared_) centers.push_back((*marker.in_shape)[0]);
    use_centers_ = NumData() >= kMinMarkersForCenters && HasSpread(centers);
    min_num_inliers_ = std::max(min_num_inliers, use_centers_ ? 3 : 1);
  }

  int NumData() const { return static_cast<int>(shared_.size()); }
  bool UseCenters() const { return use_centers_; }
  const SharedMarker& Marker(int idx) const { return shared_[static_cast<std::size_t>(idx)]; }

  // The alignment of the centres of three random markers.
  std::vector<Rigid3> Generate(std::mt19937* generator) const {
    const auto draw = [&] {
      return static_cast<int>(RandomIndex(generator, static_cast<std::size_t>(NumData())));
    };
    const int a = draw(), b = draw(), c = draw();
    if (a == b || b == c || a == c) return {};
    const std::vector<Eigen::Vector3d> centers = {
        (*Marker(a).in_shape)[0], (*Marker(b).in_shape)[0], (*Marker(c).in_shape)[0]};
    if (!HasSpread(centers)) return {};
    return {FromCenters({a, b, c})};
  }

  // The alignments of single markers, each with both of its pose solutions.
  std::vector<Rigid3> FromSingleMarkers() const {
    std::vector<Rigid3> models;
    for (const SharedMarker& marker : shared_) {
      for (const MarkerPoints& x_in_cam : marker.in_frame->x_in_cam) {
        models.push_back(EstimateRigid3({x_in_cam.begin(), x_in_cam.end()},
                                        {marker.in_shape->begin(), marker.in_shape->end()}));
      }
    }
    return models;
  }

  Rigid3 FromCenters(const std::vector<int>& idxs) const {
    std::vector<Eigen::Vector3d> x_in_cam, x_in_shape;
    for (const int idx : idxs) {
      x_in_cam.push_back(Marker(idx).in_frame->x_in_cam.front()[0]);
      x_in_shape.push_back((*Marker(idx).in_shape)[0]);
    }
    return EstimateRigid3(x_in_cam, x_in_shape);
  }

  Rigid3 FromInliers(const std::vector<int>& idxs, const Rigid3& shape_from_cam) const {
    if (use_centers_) {
      std::vector<Eigen::Vector3d> centers;
      for (const int idx : idxs) centers.push_back((*Marker(idx).in_shape)[0]);
      if (HasSpread(centers)) return FromCenters(idxs);
    }
    std::vector<Eigen::Vector3d> x_in_cam, x_in_shape;
    for (const int idx : idxs) {
      const SharedMarker& marker = Marker(idx);
      const MarkerPoints& points = BestSolution(marker, shape_from_cam);
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
    return RmsDistance(Transform(shape_from_cam, BestSolution(marker, shape_from_cam)),
                       *marker.in_shape);
  }

  AlignmentHypothesis Score(const Rigid3& shape_from_cam) const {
    AlignmentHypothesis hypothesis{shape_from_cam, 0.0, {}};
    for (int idx = 0; idx < NumData(); ++idx) {
      const double relative = Error(idx, shape_from_cam) / Marker(idx).max_error_m;
      hypothesis.cost += std::min(relative * relative, 1.0);
      if (relative <= 1.0) hypothesis.inlier_idxs.push_back(idx);
    }
    return hypothesis;
  }

  // The hypothesis itself where the fit would leave it with too few inliers.
  AlignmentHypothesis Refine(const AlignmentHypothesis& hypothesis) const {
    AlignmentHypothesis refined =
        Score(FromInliers(hypothesis.inlier_idxs, hypothesis.shape_from_cam));
    return HasEnoughInliers(refined) ? refined : hypothesis;
  }

  bool HasEnoughInliers(const AlignmentHypothesis& hypothesis) const {
    return static_cast<int>(hypothesis.inlier_idxs.size()) >= min_num_inliers_;
  }

 private:
  std::vector<SharedMarker> shared_;
  bool use_centers_ = false;
  int min_num_inliers_ = 1;
};

}  // namespace

bool IsOutlier(const FrameAlignment& alignment, int marker_id) {
  return std::binary_search(alignment.outlier_ids.begin(), alignment.outlier_ids.end(), marker_id);
}

std::optional<FrameAlignment> AlignFrame(const FrameShape& frame, const ShapePoints& shape,
                                         const Layout& layout, const RegistrationOptions& options) {
  constexpr int kNumSamples = 300;
  const AlignmentProblem problem(
      FindShared(frame, shape, layout, options.thesis.ransac_max_error_m), options.min_num_inliers);
  if (problem.NumData() < options.min_num_inliers) return std::nullopt;
  // The thesis draws a fixed number of samples.
  const int num_samples = problem.UseCenters() ? kNumSamples : 0;
  std::vector<AlignmentHypothesis> hypotheses =
      Ransac({num_samples, num_samples, static_cast<std::uint32_t>(options.random_seed)}, problem,
             problem.UseCenters() ? std::vector<Rigid3>() : problem.FromSingleMarkers());
  if (hypotheses.empty() || !problem.HasEnoughInliers(hypotheses.front())) return std::nullopt;
  const AlignmentHypothesis best =
      RefineHypothesis(problem, kMaxRefinements, std::move(hypotheses.front()));

  FrameAlignment alignment;
  alignment.shape_from_cam = best.shape_from_cam;
  double sum = 0.0;
  std::size_t next_inlier = 0;
  for (int idx = 0; idx < problem.NumData(); ++idx) {
    const bool is_inlier =
        next_inlier < best.inlier_idxs.size() && best.inlier_idxs[next_inlier] == idx;
    if (!is_inlier) {
      alignment.outlier_ids.push_back(problem.Marker(idx).marker_id);
      continue;
    }
    ++next_inlier;
    alignment.inlier_ids.push_back(problem.Marker(idx).marker_id);
    const double error = problem.Error(idx, best.shape_from_cam);
    sum += error * error;
  }
  alignment.rms_error_m = std::sqrt(sum / static_cast<double>(alignment.inlier_ids.size()));
  return alignment;
}

}  // namespace velamap
