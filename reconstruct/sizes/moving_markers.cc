#include "reconstruct/sizes/moving_markers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "importer/base/statistics.h"
#include "importer/geometry/quad.h"
#include "reconstruct/model/moved_views.h"

namespace velamap {
namespace {

// Below this number of images, a marker does not tell its own motion.
constexpr std::size_t kMinNumImages = 16;
// Those all around a marker on a grid of rows; farther ones may move otherwise.
constexpr std::size_t kNumNeighbours = 6;

// Mean residual of a marker in an image, in sigmas of a mean of independent corners.
struct MeanResidual {
  std::size_t image_idx = 0;  // in the natural order of the images' names
  Eigen::Vector2d sigmas = Eigen::Vector2d::Zero();
};
using MeanResiduals = std::vector<MeanResidual>;

// By marker, in the order of the images. Sigmas are those without the factors `present`, so that
// factors can be found anew.
std::map<int, MeanResiduals> MeanResidualsByMarker(const MarkerProblem& problem,
                                                   const std::map<int, double>& present,
                                                   const Model& model) {
  struct Sum {
    Eigen::Vector2d residuals = Eigen::Vector2d::Zero();
    double num_corners = 0.0;
  };
  const std::map<ImageId, std::size_t> image_idxs = OrderInTime(model);
  const std::vector<double> residuals = CornerResiduals(problem);
  std::map<int, std::map<std::size_t, Sum>> sums;
  for (std::size_t i = 0; i < problem.corners.size(); ++i) {
    const auto& [point3D_id, element] = problem.corners[i];
    const int marker_id = CornerFromPoint3DId(point3D_id).marker_id;
    const auto factor = present.find(marker_id);
    Sum& sum = sums[marker_id][image_idxs.at(element.image_id)];
    sum.residuals += (factor == present.end() ? 1.0 : factor->second) *
                     Eigen::Vector2d(residuals[2 * i], residuals[2 * i + 1]);
    sum.num_corners += 1.0;
  }
  std::map<int, MeanResiduals> means;
  for (const auto& [marker_id, by_image] : sums) {
    for (const auto& [image_idx, sum] : by_image) {
      means[marker_id].push_back({image_idx, sum.residuals / std::sqrt(sum.num_corners)});
    }
  }
  return means;
}

// Gross outliers count as residuals of three sigmas.
void LimitOutliers(MeanResiduals* residuals) {
  constexpr double kMedianOfSquare = 1.3863;  // chi-squared with two degrees of freedom
  constexpr double kLimit = 3.0;
  std::vector<double> squares;
  for (const MeanResidual& residual : *residuals) squares.push_back(residual.sigmas.squaredNorm());
  const double limit = kLimit * std::sqrt(Median(std::move(squares)) / kMedianOfSquare);
  for (MeanResidual& residual : *residuals) {
    const double length = residual.sigmas.norm();
    if (length > limit) residual.sigmas *= limit / length;
  }
}

// Mean of the products of a coordinate of residuals that are `lag` residuals apart.
double Covariance(const MeanResiduals& residuals, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t i = lag; i < residuals.size(); ++i) {
    sum += residuals[i].sigmas.dot(residuals[i - lag].sigmas);
  }
  return 0.5 * sum / static_cast<double>(residuals.size());
}

// Variance that independent residuals would need to move the marker as far as these do.
double IndependentVariance(const MeanResiduals& residuals) {
  double variance = Covariance(residuals, 0);
  for (std::size_t lag = 1; lag <= residuals.size() / 4; ++lag) {
    const double covariance = Covariance(residuals, lag);
    if (!(covariance > 0)) break;
    variance += 2 * covariance;
  }
  return variance;
}

// The same for a marker that only the images of `residuals` show, by the mean motion of `others`:
// theirs are the products of residuals at the same distance in time.
double VarianceByOthers(const MeanResiduals& residuals,
                        const std::vector<const MeanResiduals*>& others) {
  struct Products {
    double sum = 0.0, count = 0.0;
    double Mean() const { return count > 0 ? 0.5 * sum / count : 0.0; }
  };
  const std::size_t duration = residuals.back().image_idx - residuals.front().image_idx;
  std::vector<Products> by_lag(duration + 1);
  for (const MeanResiduals* other : others) {
    for (std::size_t i = 0; i < other->size(); ++i) {
      for (std::size_t j = i; j < other->size(); ++j) {
        const std::size_t lag = (*other)[j].image_idx - (*other)[i].image_idx;
        if (lag > duration) break;
        by_lag[lag].sum += (*other)[i].sigmas.dot((*other)[j].sigmas);
        by_lag[lag].count += 1.0;
      }
    }
  }
  const auto end = std::find_if(by_lag.begin(), by_lag.end(),
                                [](const Products& products) { return !(products.Mean() > 0); });
  const auto num_lags = static_cast<std::size_t>(end - by_lag.begin());
  double variance = 0.0;
  for (const MeanResidual& a : residuals) {
    for (const MeanResidual& b : residuals) {
      const std::size_t lag =
          std::max(a.image_idx, b.image_idx) - std::min(a.image_idx, b.image_idx);
      if (lag < num_lags) variance += by_lag[lag].Mean();
    }
  }
  return variance / static_cast<double>(residuals.size());
}

// Middle of the corners of each marker, m.
std::map<int, Eigen::Vector3d> Middles(const Model& model) {
  std::map<int, std::pair<Eigen::Vector3d, int>> sums;
  for (const auto& [point3D_id, point] : model.points3D) {
    auto& [sum, count] =
        sums.try_emplace(CornerFromPoint3DId(point3D_id).marker_id, Eigen::Vector3d::Zero(), 0)
            .first->second;
    sum += point.x_in_world;
    ++count;
  }
  std::map<int, Eigen::Vector3d> middles;
  for (const auto& [marker_id, sum] : sums) middles[marker_id] = sum.first / sum.second;
  return middles;
}

// The residuals of the markers in `known` that are closest to `marker_id`.
std::vector<const MeanResiduals*> Neighbours(int marker_id, const std::map<int, double>& known,
                                             const std::map<int, Eigen::Vector3d>& middles,
                                             const std::map<int, MeanResiduals>& residuals) {
  std::vector<std::pair<double, int>> by_distance;
  for (const auto& [other_id, variance] : known) {
    by_distance.emplace_back((middles.at(other_id) - middles.at(marker_id)).norm(), other_id);
  }
  std::sort(by_distance.begin(), by_distance.end());
  by_distance.resize(std::min(kNumNeighbours, by_distance.size()));
  std::vector<const MeanResiduals*> neighbours;
  for (const auto& [distance, other_id] : by_distance) {
    neighbours.push_back(&residuals.at(other_id));
  }
  return neighbours;
}

TrackedView ViewOf(const std::array<const CornerResidual*, kNumCorners>& corners, double max_sigmas,
                   const Model& model) {
  TrackedView view;
  QuadCorners quad;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const TrackElement& element = corners[i]->element;
    quad[i] = model.FindImage(element.image_id)->points2D.at(element.point2D_idx).x_in_image_px;
    view.errors_px[i] = corners[i]->error_px;
    view.is_outlier = view.is_outlier || corners[i]->sigmas > max_sigmas;
  }
  view.side_px = QuadMeanSide(quad);
  return view;
}

}  // namespace

std::map<int, double> MotionFactors(const MarkerProblem& problem,
                                    const std::map<int, double>& present, const Model& model) {
  constexpr double kMinFactor = 2.0;
  std::map<int, MeanResiduals> residuals = MeanResidualsByMarker(problem, present, model);
  std::map<int, double> variances;
  std::vector<double> all;
  for (auto& [marker_id, of_marker] : residuals) {
    LimitOutliers(&of_marker);
    if (of_marker.size() < kMinNumImages) continue;
    all.push_back(variances[marker_id] = IndependentVariance(of_marker));
  }
  std::map<int, double> factors;
  if (all.empty()) return factors;
  const double usual = std::max(1.0, Median(std::move(all)));
  const std::map<int, Eigen::Vector3d> middles = Middles(model);
  for (const auto& [marker_id, of_marker] : residuals) {
    const auto own = variances.find(marker_id);
    const double variance =
        own != variances.end()
            ? own->second
            : VarianceByOthers(of_marker, Neighbours(marker_id, variances, middles, residuals));
    const double factor = std::sqrt(variance / usual);
    if (factor > kMinFactor) factors.emplace(marker_id, factor);
  }
  return factors;
}

std::vector<CornerResidual> WithoutMovedViews(const std::vector<CornerResidual>& corners,
                                              double max_sigmas, const Model& model,
                                              const CornerMotions& motions) {
  using Corners = std::array<const CornerResidual*, kNumCorners>;
  std::map<int, std::map<std::size_t, Corners>> views;  // by marker and time
  const std::map<ImageId, std::size_t> order = OrderInTime(model);
  for (const CornerResidual& corner : corners) {
    if (motions.count(corner.element.image_id) == 0) continue;
    const CornerId id = CornerFromPoint3DId(corner.point3D_id);
    views[id.marker_id][order.at(corner.element.image_id)]
         [static_cast<std::size_t>(id.corner) - 1] = &corner;
  }
  std::set<const CornerResidual*> moved;
  for (const auto& [marker_id, by_time] : views) {
    std::vector<Corners> whole;
    std::vector<TrackedView> of_marker;
    for (const auto& [time, of_view] : by_time) {
      if (std::count(of_view.begin(), of_view.end(), nullptr) > 0) continue;
      whole.push_back(of_view);
      of_marker.push_back(ViewOf(of_view, max_sigmas, model));
    }
    const std::vector<bool> is_moved = FindMovedViews(of_marker);
    for (std::size_t i = 0; i < whole.size(); ++i) {
      if (is_moved[i]) moved.insert(whole[i].begin(), whole[i].end());
    }
  }
  std::vector<CornerResidual> others;
  for (const CornerResidual& corner : corners) {
    if (moved.count(&corner) == 0) others.push_back(corner);
  }
  return others;
}

}  // namespace velamap
