#include "reconstruct/map/map_intersection.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "importer/geometry/alignment.h"
#include "importer/geometry/ransac.h"
#include "reconstruct/map/map_refinement.h"
#include "reconstruct/map/map_resection.h"

namespace velamap {
namespace {

// The number of frames that supply planar solutions as hypotheses and form pairs with others.
constexpr std::size_t kMaxViews = 8;
constexpr std::size_t kMaxRefinedPlaces = 3;
// Places nearer than this to each other are one: half a side of the marker, and 0.2 rad (11
// degrees). The two planar solutions of a marker differ by twice its tilt, so a coarser limit would
// merge the solutions of a marker that is tilted by 10 degrees.
constexpr double kSamePlaceInSides = 0.5, kSamePlaceRotation = 0.2;
// Rays nearer than this to parallel do not determine a depth, rad.
constexpr double kMinParallax = 0.02;

struct View {
  int observation_idx;
  const MapObservation* observation;
  const Rigid3* cam_from_shape;
};

std::vector<View> FindViews(const MapProblem& problem, const MapSolution& solution,
                            int marker_idx) {
  std::vector<View> views;
  for (const int idx : problem.Marker(marker_idx).observation_idxs) {
    const MapObservation& observation = problem.Observation(idx);
    const auto& pose = solution.Pose(observation.frame_idx);
    if (pose) views.push_back({idx, &observation, &*pose});
  }
  return views;
}

PlaceHypothesis Evaluate(const MapProblem& problem, const std::vector<View>& views,
                         double tolerance_factor, const Sim3& shape_from_marker) {
  PlaceHypothesis hypothesis{shape_from_marker, 0.0, {}};
  for (const View& view : views) {
    const double tolerance_px = tolerance_factor * GrowthTolerance(*view.observation);
    const double error_px =
        ReprojectionError(problem, *view.observation, *view.cam_from_shape, shape_from_marker);
    hypothesis.cost += std::min(1.0, std::pow(error_px / tolerance_px, 2));
    if (error_px <= tolerance_px) hypothesis.inlier_idxs.push_back(view.observation_idx);
  }
  return hypothesis;
}

Sim3 Place(const Rigid3& shape_from_marker) {
  return {1.0, shape_from_marker.rotation, shape_from_marker.translation};
}

// The square through the midpoints between the rays of two views.
std::optional<Sim3> Triangulate(const MapProblem& problem, const View& a, const View& b) {
  const Rigid3 shape_from_a = Inverse(*a.cam_from_shape), shape_from_b = Inverse(*b.cam_from_shape);
  std::vector<Eigen::Vector3d> in_shape;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const Eigen::Vector3d ray_a =
        (shape_from_a.rotation * a.observation->rays[i].homogeneous()).normalized();
    const Eigen::Vector3d ray_b =
        (shape_from_b.rotation * b.observation->rays[i].homogeneous()).normalized();
    const double cosine = ray_a.dot(ray_b), squared_sine = 1 - cosine * cosine;
    if (squared_sine < kMinParallax * kMinParallax) return std::nullopt;
    const Eigen::Vector3d baseline = shape_from_b.translation - shape_from_a.translation;
    const double along_a = (baseline.dot(ray_a) - cosine * baseline.dot(ray_b)) / squared_sine;
    const double along_b = (cosine * baseline.dot(ray_a) - baseline.dot(ray_b)) / squared_sine;
    if (!(along_a > 0 && along_b > 0)) return std::nullopt;
    in_shape.push_back(0.5 * (shape_from_a.translation + along_a * ray_a +
                              shape_from_b.translation + along_b * ray_b));
  }
  const auto& corners = problem.Marker(a.observation->marker_idx).corners_in_marker;
  const Sim3 place = EstimateSim3({corners.begin(), corners.end()}, in_shape);
  if (!(place.scale > 0)) return std::nullopt;
  return place;
}

// At most `max_count` of the views, spread by the golden ratio, because even steps may coincide
// with a periodic motion.
std::vector<std::size_t> SpreadIdxs(std::size_t size, std::size_t max_count) {
  std::vector<std::size_t> idxs(std::min(size, max_count));
  if (size <= max_count) {
    std::iota(idxs.begin(), idxs.end(), 0);
    return idxs;
  }
  constexpr double kGoldenRatio = 0.6180339887498949;
  double place = 0.5;
  for (std::size_t& idx : idxs) {
    idx = static_cast<std::size_t>(place * static_cast<double>(size));
    place += kGoldenRatio;
    place -= std::floor(place);
  }
  return idxs;
}

std::vector<Sim3> Candidates(const MapProblem& problem, const std::vector<View>& views) {
  std::vector<Sim3> candidates;
  for (const std::size_t i : SpreadIdxs(views.size(), kMaxViews)) {
    const Rigid3 shape_from_cam = Inverse(*views[i].cam_from_shape);
    for (const Rigid3& cam_from_marker : views[i].observation->cam_from_marker) {
      candidates.push_back(Place(shape_from_cam * cam_from_marker));
    }
    for (const std::size_t apart : {views.size() / 3, views.size() / 2}) {
      const std::size_t other = (i + std::max<std::size_t>(apart, 1)) % views.size();
      if (other == i) continue;
      const auto triangulated = Triangulate(problem, views[i], views[other]);
      if (triangulated) candidates.push_back(*triangulated);
    }
  }
  return candidates;
}

// Refines a place to the views that agree with it, see RefineHypothesis() in ransac.h.
struct PlaceConsensus {
  using Hypothesis = PlaceHypothesis;

  PlaceHypothesis Score(const Sim3& shape_from_marker) const {
    return Evaluate(problem, views, tolerance_factor, shape_from_marker);
  }
  PlaceHypothesis Refine(const PlaceHypothesis& hypothesis) const {
    if (hypothesis.inlier_idxs.empty()) return hypothesis;
    return Score(
        RefineMarkerPlace(problem, solution, hypothesis.inlier_idxs, hypothesis.shape_from_marker));
  }

  const MapProblem& problem;
  const MapSolution& solution;
  const std::vector<View>& views;
  double tolerance_factor;
};

std::vector<PlaceHypothesis> RankPlaces(const MapProblem& problem, const MapSolution& solution,
                                        const std::vector<View>& views, double tolerance_factor) {
  constexpr double kCoarse = 3.0;  // before candidates are refined
  constexpr int kMaxRounds = 4;
  const double length_m =
      2 * problem.Marker(views.front().observation->marker_idx).corners_in_marker[1].x();
  const auto is_same = [length_m](const PlaceHypothesis& a, const PlaceHypothesis& b) {
    const Sim3 &place_a = a.shape_from_marker, &place_b = b.shape_from_marker;
    return (place_a.translation - place_b.translation).norm() <
               kSamePlaceInSides * length_m * place_a.scale &&
           place_a.rotation.angularDistance(place_b.rotation) < kSamePlaceRotation;
  };
  const PlaceConsensus coarse{problem, solution, views, kCoarse * tolerance_factor};
  const PlaceConsensus fine{problem, solution, views, tolerance_factor};
  std::vector<PlaceHypothesis> hypotheses;
  for (const Sim3& candidate : Candidates(problem, views)) {
    hypotheses.push_back(coarse.Score(candidate));
  }
  std::vector<PlaceHypothesis> refined;
  for (PlaceHypothesis& hypothesis :
       DistinctHypotheses(std::move(hypotheses), is_same, kMaxRefinedPlaces)) {
    const Sim3 place =
        RefineHypothesis(coarse, kMaxRounds, std::move(hypothesis)).shape_from_marker;
    refined.push_back(RefineHypothesis(fine, kMaxRounds, fine.Score(place)));
  }
  return DistinctHypotheses(std::move(refined), is_same, kMaxRefinedPlaces);
}

}  // namespace

std::vector<Sim3> MarkerPlacement::ShapeFromMarker() const {
  std::vector<Sim3> shape_from_marker;
  for (const PlaceHypothesis& place : places) shape_from_marker.push_back(place.shape_from_marker);
  return shape_from_marker;
}

MarkerPlacement PlaceMarker(const MapProblem& problem, const MapSolution& solution, int marker_idx,
                            double tolerance_factor) {
  const std::vector<View> views = FindViews(problem, solution, marker_idx);
  MarkerPlacement placement;
  placement.num_seen = static_cast<int>(views.size());
  if (views.empty()) return placement;
  if (views.size() == 1) {
    const View& view = views.front();
    for (const Rigid3& cam_from_marker : view.observation->cam_from_marker) {
      placement.places.push_back(
          {Place(Inverse(*view.cam_from_shape) * cam_from_marker), 0.0, {view.observation_idx}});
    }
    return placement;
  }
  std::vector<PlaceHypothesis> ranked = RankPlaces(problem, solution, views, tolerance_factor);
  if (ranked.empty() || ranked.front().inlier_idxs.size() < 2) return placement;
  const PlaceHypothesis best = ranked.front();
  placement.places.push_back(best);
  if (IsAmbiguous(ranked)) placement.places.push_back(ranked[1]);
  std::vector<View> elsewhere;
  for (const View& view : views) {
    if (!std::binary_search(best.inlier_idxs.begin(), best.inlier_idxs.end(),
                            view.observation_idx)) {
      elsewhere.push_back(view);
    }
  }
  if (elsewhere.size() >= 2) {
    const auto others = RankPlaces(problem, solution, elsewhere, tolerance_factor);
    if (!others.empty() && others.front().inlier_idxs.size() >= 2) {
      placement.elsewhere_idxs = others.front().inlier_idxs;
    }
  }
  return placement;
}

}  // namespace velamap
