#include "reconstruct/sizes/bent_corners.h"

#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "importer/geometry/symmetric_eigen.h"
#include "importer/geometry/unit_square_map.h"
#include "reconstruct/sizes/marker_curvature.h"

namespace velamap {
namespace {

// A square with sides along the surface.
class BentSquare {
 public:
  BentSquare(double length_m, const Eigen::Matrix2d& curvature_1_m)
      : length_m_(length_m), principal_(DecomposeSymmetric(curvature_1_m)) {
    for (const Eigen::Vector2d& uv : kUnitSquare) middle_of_corners_m_ += FromMiddle(uv) / 4;
  }

  static inline const std::array<Eigen::Vector2d, kNumCorners> kUnitSquare = {
      {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

  // In the marker frame, whose origin is the mean of the corners.
  Eigen::Vector3d PlaceOf(const Eigen::Vector2d& uv) const {
    return FromMiddle(uv) - middle_of_corners_m_;
  }

 private:
  // Relative to the middle of the surface. Along each principal direction it is an arc.
  Eigen::Vector3d FromMiddle(const Eigen::Vector2d& uv) const {
    constexpr double kStraight_1_m = 1e-9;
    const Eigen::Vector2d flat_m = length_m_ * Eigen::Vector2d(uv.x() - 0.5, 0.5 - uv.y());
    Eigen::Vector3d place(flat_m.x(), flat_m.y(), 0);
    for (int i = 0; i < 2; ++i) {
      const double curvature_1_m = principal_.values[i];
      if (std::abs(curvature_1_m) < kStraight_1_m) continue;
      const Eigen::Vector2d direction = principal_.vectors.col(i);
      const double arc_m = direction.dot(flat_m), angle = curvature_1_m * arc_m;
      place.head<2>() += direction * (std::sin(angle) / curvature_1_m - arc_m);
      place.z() += (1 - std::cos(angle)) / curvature_1_m;
    }
    return place;
  }

  double length_m_;
  SymmetricEigen principal_;
  Eigen::Vector3d middle_of_corners_m_ = Eigen::Vector3d::Zero();
};

// The views of one marker: indices of its image points, by image and corner.
using MarkerViews = std::map<ImageId, std::map<int, std::uint32_t>>;

std::map<int, MarkerViews> ViewsOf(const Model& model,
                                   const std::vector<RemovedObservation>& removed) {
  std::map<int, MarkerViews> views;
  const auto add = [&](Point3DId point3D_id, const TrackElement& element) {
    const CornerId id = CornerFromPoint3DId(point3D_id);
    views[id.marker_id][element.image_id][id.corner] = element.point2D_idx;
  };
  for (const auto& [point3D_id, point] : model.points3D) {
    for (const TrackElement& element : point.track) add(point3D_id, element);
  }
  for (const RemovedObservation& observation : removed) {
    add(observation.point3D_id, observation.element);
  }
  return views;
}

bool HasSigma(const CornerErrors& errors, ImageId image_id, std::uint32_t point2D_idx) {
  const auto sigmas_px = errors.sigmas_px.find(image_id);
  return sigmas_px != errors.sigmas_px.end() && sigmas_px->second.at(point2D_idx) > 0;
}

}  // namespace

QuadCorners CornerShiftsBySurface(const Camera& camera, const Rigid3& cam_from_marker,
                                  double length_m, const Eigen::Matrix2d& curvature_1_m) {
  const BentSquare square(length_m, curvature_1_m);
  const auto place_in_cam = [&](const Eigen::Vector2d& uv) -> Eigen::Vector3d {
    return cam_from_marker * square.PlaceOf(uv);
  };
  QuadCorners none;
  none.fill(Eigen::Vector2d::Zero());
  QuadCorners rays, corners_px;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const Eigen::Vector3d corner_in_cam = place_in_cam(BentSquare::kUnitSquare[i]);
    const auto corner_px = ImageFromCam(camera, corner_in_cam);
    if (!corner_px) return none;
    rays[i] = corner_in_cam.hnormalized();
    corners_px[i] = *corner_px;
  }
  const UnitSquareMap flat_map(rays);
  const PatternBend bend =
      BendByDisplacements([&](const Eigen::Vector2d& uv) -> std::optional<Eigen::Vector2d> {
        const auto bent_px = ImageFromCam(camera, place_in_cam(uv));
        const auto flat_px = ImageFromCam(camera, flat_map.ToImage(uv.x(), uv.y()).homogeneous());
        if (!bent_px || !flat_px) return std::nullopt;
        return *bent_px - *flat_px;
      });
  return CornerShiftsByBend(bend, corners_px);
}

void CorrectForBentMarkers(const std::map<int, Eigen::Matrix2d>& curvatures_1_m,
                           const MarkerState& state, const CornerErrors& errors,
                           const std::vector<RemovedObservation>& removed, Model* model) {
  const std::map<int, MarkerViews> views = ViewsOf(*model, removed);
  for (const MarkerBlock& marker : state.markers) {
    const auto curvature = curvatures_1_m.find(marker.marker_id);
    if (curvature == curvatures_1_m.end()) continue;
    const auto world_from_marker = WorldFromMarker(marker);
    if (!world_from_marker) continue;
    for (const auto& [image_id, point2D_idxs] : views.at(marker.marker_id)) {
      ModelImage* image = model->FindImage(image_id);
      if (image == nullptr) continue;
      const QuadCorners shifts_px = CornerShiftsBySurface(
          model->cameras.at(image->camera_id), image->cam_from_world * *world_from_marker,
          marker.length_m, curvature->second);
      for (const auto& [corner, point2D_idx] : point2D_idxs) {
        if (!HasSigma(errors, image_id, point2D_idx)) continue;
        image->points2D.at(point2D_idx).x_in_image_px -=
            shifts_px[static_cast<std::size_t>(corner - 1)];
      }
    }
  }
}

}  // namespace velamap
