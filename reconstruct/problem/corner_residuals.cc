#include "reconstruct/problem/corner_residuals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "importer/base/natural_order.h"
#include "importer/base/statistics.h"

namespace velamap {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double ReprojectionErrorPx(const Model& model, Point3DId point3D_id, const TrackElement& element) {
  const ModelImage& image = *model.FindImage(element.image_id);
  const auto projection =
      ImageFromCam(model.cameras.at(image.camera_id),
                   image.cam_from_world * model.points3D.at(point3D_id).x_in_world);
  if (!projection) return kInfinity;
  return (*projection - image.points2D.at(element.point2D_idx).x_in_image_px).norm();
}

// Lengths of the markers' sides in all images, px, by marker id.
std::map<int, std::vector<double>> SidesPx(const Model& model) {
  std::map<int, std::vector<double>> sides_px;
  for (const ModelImage& image : model.images) {
    std::map<Point3DId, Eigen::Vector2d> corners_px;
    for (const Point2D& point : image.points2D) {
      if (point.point3D_id != kInvalidPoint3DId) corners_px[point.point3D_id] = point.x_in_image_px;
    }
    for (const auto& [point3D_id, corner_px] : corners_px) {
      const CornerId id = CornerFromPoint3DId(point3D_id);
      const auto next =
          corners_px.find(Point3DIdFromCorner({id.marker_id, id.corner % kNumCorners + 1}));
      if (next != corners_px.end()) {
        sides_px[id.marker_id].push_back((next->second - corner_px).norm());
      }
    }
  }
  return sides_px;
}

// Mean residual of a marker in an image, in sigmas of a mean of independent corners.
using MeanResiduals = std::vector<Eigen::Vector2d>;

// By marker, in the natural order of the images' names. Sigmas are those without the factors
// `present`, so that factors can be found anew.
std::map<int, MeanResiduals> MeanResidualsByMarker(const MarkerProblem& problem,
                                                   const std::map<int, double>& present,
                                                   const Model& model) {
  struct Sum {
    Eigen::Vector2d residuals = Eigen::Vector2d::Zero();
    double num_corners = 0.0;
  };
  std::vector<const ModelImage*> images;
  for (const ModelImage& image : model.images) images.push_back(&image);
  std::sort(images.begin(), images.end(),
            [](const ModelImage* a, const ModelImage* b) { return NaturalLess(a->name, b->name); });
  std::map<ImageId, std::size_t> image_idxs;
  for (std::size_t i = 0; i < images.size(); ++i) image_idxs.emplace(images[i]->image_id, i);
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
      means[marker_id].push_back(sum.residuals / std::sqrt(sum.num_corners));
    }
  }
  return means;
}

// Mean of the products of a coordinate of residuals that are `lag` images apart.
double Covariance(const MeanResiduals& residuals, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t i = lag; i < residuals.size(); ++i) sum += residuals[i].dot(residuals[i - lag]);
  return 0.5 * sum / static_cast<double>(residuals.size());
}

// Variance that independent residuals would need to move the marker as far as these do. Gross
// outliers count as residuals of three sigmas.
double IndependentVariance(MeanResiduals residuals) {
  constexpr double kMedianOfSquare = 1.3863;  // chi-squared with two degrees of freedom
  constexpr double kLimit = 3.0;
  std::vector<double> squares;
  for (const Eigen::Vector2d& residual : residuals) squares.push_back(residual.squaredNorm());
  const double limit = kLimit * std::sqrt(Median(std::move(squares)) / kMedianOfSquare);
  for (Eigen::Vector2d& residual : residuals) {
    const double length = residual.norm();
    if (length > limit) residual *= limit / length;
  }
  double variance = Covariance(residuals, 0);
  for (std::size_t lag = 1; lag <= residuals.size() / 4; ++lag) {
    const double covariance = Covariance(residuals, lag);
    if (!(covariance > 0)) break;
    variance += 2 * covariance;
  }
  return variance;
}

}  // namespace

std::map<int, double> MotionFactors(const MarkerProblem& problem,
                                    const std::map<int, double>& present, const Model& model) {
  constexpr std::size_t kMinNumImages = 16;
  constexpr double kMinFactor = 2.0;
  std::map<int, double> variances;
  std::vector<double> all;
  for (const auto& [marker_id, residuals] : MeanResidualsByMarker(problem, present, model)) {
    if (residuals.size() < kMinNumImages) continue;
    all.push_back(variances[marker_id] = IndependentVariance(residuals));
  }
  std::map<int, double> factors;
  if (all.empty()) return factors;
  const double usual = std::max(1.0, Median(std::move(all)));
  for (const auto& [marker_id, variance] : variances) {
    const double factor = std::sqrt(variance / usual);
    if (factor > kMinFactor) factors.emplace(marker_id, factor);
  }
  return factors;
}

std::vector<CornerResidual> EvaluateCorners(const MarkerProblem& problem) {
  const std::vector<double> residuals = CornerResiduals(problem);
  std::vector<CornerResidual> corners;
  for (std::size_t i = 0; i < problem.corners.size(); ++i) {
    corners.push_back({problem.corners[i].first, problem.corners[i].second,
                       std::hypot(residuals[2 * i], residuals[2 * i + 1])});
  }
  return corners;
}

VarianceFactor RobustVarianceFactor(const std::vector<CornerResidual>& corners,
                                    const Model& model) {
  std::vector<double> squares;
  for (const CornerResidual& corner : corners) squares.push_back(corner.sigmas * corner.sigmas);
  const double num_residuals = 2.0 * static_cast<double>(squares.size());
  const double num_parameters = 6.0 * static_cast<double>(model.images.size() - 1) +
                                3.0 * static_cast<double>(model.points3D.size());
  const double redundancy = std::max(0.2 * num_residuals, num_residuals - num_parameters);
  return {Median(std::move(squares)) / kChiSquaredMedian2 * num_residuals / redundancy, redundancy};
}

void RemoveOutliers(const std::vector<CornerResidual>& corners, double max_sigmas, Model* model,
                    std::vector<RemovedObservation>* removed) {
  for (const CornerResidual& corner : corners) {
    if (corner.sigmas <= max_sigmas) continue;
    removed->push_back({corner.point3D_id, corner.element,
                        ReprojectionErrorPx(*model, corner.point3D_id, corner.element)});
    RemoveObservation(model, corner.point3D_id, corner.element);
  }
}

std::map<int, double> MeanSidesPx(const Model& model) {
  std::map<int, double> means_px;
  for (const auto& [marker_id, sides_px] : SidesPx(model)) {
    means_px[marker_id] = ComputeStatistics(sides_px).mean;
  }
  return means_px;
}

double MedianSidePx(const Model& model) {
  std::vector<double> all_px;
  for (const auto& [marker_id, sides_px] : SidesPx(model)) {
    all_px.insert(all_px.end(), sides_px.begin(), sides_px.end());
  }
  return all_px.empty() ? kInfinity : Median(std::move(all_px));
}

}  // namespace velamap
