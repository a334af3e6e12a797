#include "exporters/scale/marker_sides.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>

#include "exporters/scale/metric_shape.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/base/statistics.h"
#include "importer/camera/camera_jacobian.h"
#include "importer/geometry/least_squares.h"
#include "importer/geometry/pose_step.h"
#include "importer/geometry/quad.h"

namespace velamap {
namespace {

// The normal equations of one point with fixed cameras.
class PointEquations : public GaussNewtonEquations<3> {
 public:
  int num_observations = 0;

  const Eigen::Matrix3d& Information() const { return hessian(); }  // of one px of noise
  double SumOfSquares_px2() const { return 2 * cost(); }
};

PointEquations EquationsOf(const Model& model, const std::map<ImageId, const ModelImage*>& images,
                           const Point3D& point) {
  PointEquations equations;
  // Sorted by image, so that sums do not depend on the order of the track.
  std::map<ImageId, TrackElement> track;
  for (const TrackElement& element : point.track) track[element.image_id] = element;
  for (const auto& [image_id, element] : track) {
    const ModelImage& image = *images.at(image_id);
    const Camera& camera = model.cameras.at(image.camera_id);
    const Eigen::Vector3d x_in_cam = image.cam_from_world * point.x_in_world;
    if (!(x_in_cam.z() > 0)) continue;
    const ImagePoint seen = ImageFromPointWithJacobian(camera, x_in_cam);
    const Eigen::Matrix<double, 2, 3> by_world =
        seen.by_point * image.cam_from_world.rotation.toRotationMatrix();
    equations.Add<2>(by_world,
                     seen.value_px - image.points2D.at(element.point2D_idx).x_in_image_px);
    ++equations.num_observations;
  }
  return equations;
}

std::map<ImageId, const ModelImage*> ImagesById(const Model& model) {
  std::map<ImageId, const ModelImage*> images;
  for (const ModelImage& image : model.images) images[image.image_id] = &image;
  return images;
}

// The four image points of every marker whose corners an image sees all.
std::map<int, QuadCorners> WholeMarkersIn(const ModelImage& image) {
  std::map<int, std::map<int, Eigen::Vector2d>> corners;
  for (const Point2D& point : image.points2D) {
    if (!IsCornerPoint3DId(point.point3D_id)) continue;
    const CornerId id = CornerFromPoint3DId(point.point3D_id);
    corners[id.marker_id][id.corner] = point.x_in_image_px;
  }
  std::map<int, QuadCorners> whole;
  for (const auto& [marker_id, by_corner] : corners) {
    if (by_corner.size() < kNumCorners) continue;
    for (const auto& [corner, x] : by_corner) whole[marker_id][corner - 1] = x;
  }
  return whole;
}

// The mean side of each marker in the images, weighted by the side itself, px.
std::map<int, double> SidesInImages(const Model& model) {
  std::map<int, std::pair<double, double>> sums;
  for (const auto& [image_id, image] : ImagesById(model)) {
    for (const auto& [marker_id, corners] : WholeMarkersIn(*image)) {
      const double side_px = QuadMeanSide(corners);
      sums[marker_id].first += side_px * side_px;
      sums[marker_id].second += side_px;
    }
  }
  std::map<int, double> sides_px;
  for (const auto& [marker_id, sum] : sums) sides_px[marker_id] = sum.first / sum.second;
  return sides_px;
}

struct MarkerEquations {
  std::array<PointEquations, kNumCorners> corners;
  double sum_of_squares_px2 = 0.0;
  int redundancy = 0;  // number of residuals minus number of coordinates
  double variance_px2 = 0.0;

  bool IsDetermined() const {
    return std::all_of(corners.begin(), corners.end(),
                       [](const PointEquations& corner) { return corner.num_observations > 1; });
  }
};

// Factor of the variance for the part of the residuals that the cameras absorb.
double CameraFactor(const std::map<int, MarkerEquations>& markers, std::size_t num_images) {
  constexpr double kMaxFactor = 3.0;
  double redundancy = 0.0;
  for (const auto& [marker_id, marker] : markers) redundancy += marker.redundancy;
  const double left = redundancy - 6.0 * static_cast<double>(num_images);
  return left * kMaxFactor > redundancy ? redundancy / left : kMaxFactor;
}

void SetVariances(std::size_t num_images, std::map<int, MarkerEquations>* markers) {
  constexpr double kPriorRedundancy = 8.0;
  std::vector<double> variances_px2;
  for (const auto& [marker_id, marker] : *markers) {
    if (marker.redundancy > 0) {
      variances_px2.push_back(marker.sum_of_squares_px2 / marker.redundancy);
    }
  }
  const double typical_px2 = variances_px2.empty() ? 0.0 : Median(variances_px2);
  const double camera_factor = CameraFactor(*markers, num_images);
  for (auto& [marker_id, marker] : *markers) {
    marker.variance_px2 = camera_factor *
                          (marker.sum_of_squares_px2 + kPriorRedundancy * typical_px2) /
                          (marker.redundancy + kPriorRedundancy);
  }
}

std::map<int, MarkerEquations> EquationsOfMarkers(const Model& model) {
  const auto images = ImagesById(model);
  std::map<int, MarkerEquations> markers;
  for (const auto& [point3D_id, point] : model.points3D) {
    if (!IsCornerPoint3DId(point3D_id)) continue;
    const CornerId id = CornerFromPoint3DId(point3D_id);
    MarkerEquations& marker = markers[id.marker_id];
    PointEquations& corner = marker.corners[id.corner - 1];
    corner = EquationsOf(model, images, point);
    marker.sum_of_squares_px2 += corner.SumOfSquares_px2();
    marker.redundancy += std::max(0, 2 * corner.num_observations - 3);
  }
  SetVariances(model.images.size(), &markers);
  return markers;
}

// 1 sigma of the function with this gradient with respect to the four corners.
double SigmaOf(const MarkerEquations& equations, const PointGradient& gradient) {
  std::array<Eigen::Vector3d, kNumCorners> by_corner;
  by_corner.fill(Eigen::Vector3d::Zero());
  for (const auto& [point3D_id, weight] : gradient) {
    by_corner[CornerFromPoint3DId(point3D_id).corner - 1] += weight;
  }
  double variance = 0.0;
  for (int i = 0; i < kNumCorners; ++i) {
    variance += equations.variance_px2 *
                by_corner[i].dot(equations.corners[i].Information().ldlt().solve(by_corner[i]));
  }
  return std::sqrt(std::max(0.0, variance));
}

PointGradient RatioGradient(const ShapeMarker& marker, const MeasuredMarkerSides& measured) {
  const auto& sides = measured.sides;
  PointGradient gradient;  // of the logarithm
  for (int side = 1; side <= kNumCorners; ++side) {
    const double weight =
        side % 2 == 1 ? 1.0 / (sides[0] + sides[2]) : -1.0 / (sides[1] + sides[3]);
    for (const auto& [point3D_id, by_point] : SideGradient(marker, side)) {
      gradient.emplace_back(point3D_id, weight * by_point);
    }
  }
  return gradient;
}

// The position of a point with fixed cameras, as a problem of MinimizeSquares().
struct IntersectionProblem : LeastSquaresProblem<3> {
  using Parameters = Eigen::Vector3d;
  using Equations = PointEquations;

  const Model& model;
  const std::map<ImageId, const ModelImage*>& images;
  const Point3D& point;

  IntersectionProblem(const Model& m, const std::map<ImageId, const ModelImage*>& by_id,
                      const Point3D& p)
      : model(m), images(by_id), point(p) {}

  void Evaluate(const Eigen::Vector3d& x_in_world, bool, PointEquations* equations) const {
    Point3D moved = point;
    moved.x_in_world = x_in_world;
    *equations = EquationsOf(model, images, moved);
    if (equations->num_observations < 2) equations->Reject();
  }
  Eigen::Vector3d Plus(const Eigen::Vector3d& x_in_world, const Step& step) const {
    return x_in_world + step;
  }
  // RMS change of the residuals, px.
  double StepSize(const Step& step, const PointEquations& equations) const {
    return std::sqrt(step.dot(equations.Information() * step) / equations.num_observations);
  }
};

// Keeps the point if the search does not converge.
void IntersectPoint(const Model& model, const std::map<ImageId, const ModelImage*>& images,
                    Point3D* point) {
  LeastSquaresOptions options;
  options.initial_damping = 1e-9;
  options.min_step = 1e-7;
  Eigen::Vector3d x_in_world = point->x_in_world;
  PointEquations equations;
  if (MinimizeSquares(options, IntersectionProblem(model, images, *point), &x_in_world,
                      &equations) == Convergence::kConverged) {
    point->x_in_world = x_in_world;
  }
}

// Corrects corners that the detector sees `inset_px` too far inside along both sides of the marker.
void MoveOut(double inset_px, ModelImage* image) {
  const std::map<int, QuadCorners> markers = WholeMarkersIn(*image);
  for (Point2D& point : image->points2D) {
    if (!IsCornerPoint3DId(point.point3D_id)) continue;
    const CornerId id = CornerFromPoint3DId(point.point3D_id);
    const auto marker = markers.find(id.marker_id);
    if (marker == markers.end()) continue;
    const QuadCorners& corners = marker->second;
    const Eigen::Vector2d& here = corners[id.corner - 1];
    const Eigen::Vector2d& next = corners[id.corner % kNumCorners];
    const Eigen::Vector2d& previous = corners[(id.corner + 2) % kNumCorners];
    point.x_in_image_px -= inset_px * ((next - here).normalized() + (previous - here).normalized());
  }
}

}  // namespace

double MeasuredMarkerSides::HorizontalOverVertical() const {
  return (sides[0] + sides[2]) / (sides[1] + sides[3]);
}

std::vector<MeasuredMarkerSides> MeasureSides(const MarkerShape& shape) {
  std::vector<MeasuredMarkerSides> markers;
  for (const ShapeMarker& marker : shape.markers) {
    if (!marker.IsWhole()) continue;
    MeasuredMarkerSides measured;
    measured.marker_id = marker.marker_id;
    measured.part = marker.part;
    measured.sides = MarkerSides(marker);
    markers.push_back(measured);
  }
  return markers;
}

std::vector<MeasuredMarkerSides> MeasureSides(const Model& model, const Layout& layout) {
  const MarkerShape shape = ShapeFromModel(model, layout);
  const std::map<int, MarkerEquations> equations_of = EquationsOfMarkers(model);
  const std::map<int, double> sides_px = SidesInImages(model);
  std::vector<MeasuredMarkerSides> markers = MeasureSides(shape);
  for (MeasuredMarkerSides& measured : markers) {
    const auto side_px = sides_px.find(measured.marker_id);
    if (side_px != sides_px.end()) measured.side_px = side_px->second;
    const MarkerEquations& equations = equations_of.at(measured.marker_id);
    const auto& sides = measured.sides;
    if (!equations.IsDetermined() || *std::min_element(sides.begin(), sides.end()) == 0) continue;
    const ShapeMarker& marker = *FindWholeMarker(shape, measured.marker_id);
    measured.mean_sigma = SigmaOf(equations, MeanSideGradient(marker)) / MeanSide(measured.sides);
    measured.ratio_sigma = SigmaOf(equations, RatioGradient(marker, measured));
  }
  return markers;
}

void RetriangulateCorners(double apparent_inset_px, Model* model) {
  if (apparent_inset_px != 0) {
    for (ModelImage& image : model->images) MoveOut(apparent_inset_px, &image);
  }
  const auto images = ImagesById(*model);
  for (auto& [point3D_id, point] : model->points3D) IntersectPoint(*model, images, &point);
}

}  // namespace velamap
