#include "reconstruct/problem/corner_residuals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

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

}  // namespace

std::vector<CornerResidual> EvaluateCorners(const MarkerProblem& problem) {
  const std::vector<double> residuals = CornerResiduals(problem);
  std::vector<CornerResidual> corners;
  for (std::size_t i = 0; i < problem.corners.size(); ++i) {
    const Eigen::Vector2d in_sigmas(residuals[2 * i], residuals[2 * i + 1]);
    corners.push_back({problem.corners[i].first, problem.corners[i].second,
                       problem.corner_sigmas_px[i] * in_sigmas, in_sigmas.norm()});
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
