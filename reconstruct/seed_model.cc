#include "reconstruct/seed_model.h"

#include <algorithm>
#include <array>
#include <ostream>

#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "importer/text/csv.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/reprojection.h"

namespace velamap {
namespace {

using ColorSums = std::map<Point3DId, std::array<int, 3>>;

const DatabaseImage& FindImage(const std::vector<DatabaseImage>& images, ImageId image_id) {
  const auto it = std::find_if(images.begin(), images.end(), [image_id](const DatabaseImage& i) {
    return i.image_id == image_id;
  });
  VELAMAP_CHECK(it != images.end());
  return *it;
}

// Adds the image with all its keypoints, and the track elements of its inliers.
void AddImage(const RegisteredFrame& frame, const DatabaseImage& database_image,
              const ShapePoints& shape, Model* model, ColorSums* color_sums) {
  ModelImage image{
      frame.image_id, database_image.camera_id, frame.image_name, *frame.cam_from_shape, {}};
  for (const MarkerDetection& marker : database_image.detections.markers) {
    const bool stays =
        std::binary_search(frame.marker_ids.begin(), frame.marker_ids.end(), marker.marker_id);
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const std::size_t corner_idx = static_cast<std::size_t>(corner - 1);
      Point2D point2D{marker.corners_in_image_px[corner_idx], kInvalidPoint3DId};
      if (stays) {
        point2D.point3D_id = Point3DIdFromCorner({marker.marker_id, corner});
        Point3D& point = model->points3D[point2D.point3D_id];
        point.x_in_world = shape.at(marker.marker_id)[static_cast<std::size_t>(corner)];
        point.track.push_back({image.image_id, static_cast<std::uint32_t>(image.points2D.size())});
        std::array<int, 3>& sums = (*color_sums)[point2D.point3D_id];
        for (std::size_t i = 0; i < 3; ++i) sums[i] += marker.colors[corner_idx][i];
      }
      image.points2D.push_back(point2D);
    }
  }
  model->images.push_back(std::move(image));
}

void SetColors(const ColorSums& color_sums, Model* model) {
  for (auto& [point3D_id, point] : model->points3D) {
    const int count = static_cast<int>(point.track.size());
    const std::array<int, 3>& sums = color_sums.at(point3D_id);
    for (std::size_t i = 0; i < 3; ++i) {
      point.color[i] = static_cast<std::uint8_t>((sums[i] + count / 2) / count);
    }
  }
}

}  // namespace

Model MakeSeedModel(const Registration& registration, const std::vector<DatabaseImage>& images,
                    const std::map<CameraId, Camera>& cameras) {
  constexpr std::size_t kMinMarkers = 2;
  Model model;
  ColorSums color_sums;
  for (const RegisteredFrame& frame : registration.frames) {
    if (!frame.cam_from_shape || frame.marker_ids.size() < kMinMarkers) continue;
    const DatabaseImage& image = FindImage(images, frame.image_id);
    model.cameras.emplace(image.camera_id, cameras.at(image.camera_id));
    AddImage(frame, image, registration.shape, &model, &color_sums);
  }
  SetColors(color_sums, &model);
  const int min_num_images = registration.NumRegistered() == 1 ? 1 : 2;
  RemoveShortTracks(&model, min_num_images);
  if (static_cast<int>(model.images.size()) < min_num_images || model.points3D.empty()) {
    throw DataError(
        "fewer than two images share markers, so there is nothing to adjust; take more pictures "
        "that show the same markers");
  }
  // Another image becomes the origin if the filters have removed the central one.
  const ImageId first = model.FindImage(registration.central_image_id) != nullptr
                            ? registration.central_image_id
                            : model.images.front().image_id;
  OrderForGauge(first, &model);
  UpdatePointErrors(&model);
  return model;
}

void WriteRegistrationCsv(const Registration& registration, std::ostream& out) {
  CsvWriter csv(out);
  csv.WriteRecord("image_name", "registered", "num_markers", "num_outliers", "rms_error_mm",
                  "reason", "outliers");
  for (const RegisteredFrame& frame : registration.frames) {
    std::string outliers;
    for (const OutlierMarker& outlier : frame.outliers) {
      outliers += (outliers.empty() ? "" : "; ") + std::to_string(outlier.marker_id);
      if (!outlier.reason.empty()) outliers += ": " + outlier.reason;
    }
    csv.WriteRecord(frame.image_name, frame.cam_from_shape.has_value(), frame.marker_ids.size(),
                    frame.outliers.size(), kMmPerM * frame.rms_error_m, frame.left_out.reason,
                    outliers);
  }
}

}  // namespace velamap
