#include "reconstruct/geometry/frame_shape.h"

#include <cmath>

#include "reconstruct/geometry/marker_pose.h"

namespace velamap {

MarkerPoints Transform(const Rigid3& b_from_a, const MarkerPoints& x_in_a) {
  MarkerPoints x_in_b;
  for (std::size_t i = 0; i < x_in_a.size(); ++i) x_in_b[i] = b_from_a * x_in_a[i];
  return x_in_b;
}

double RmsDistance(const MarkerPoints& a, const MarkerPoints& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

FrameShape EstimateFrameShape(const DatabaseImage& image, const Camera& camera,
                              const Layout& layout) {
  constexpr double kCornerSigmaPx = 0.25;
  FrameShape frame{image.image_id, image.detections.image_name, image.detections.frame_number, {}};
  for (const MarkerDetection& detection : image.detections.markers) {
    const double length_m = MarkerLength(layout, detection.marker_id);
    const auto corners_in_marker = CornersInMarker(length_m);
    FrameMarker marker{detection.marker_id, {}, detection.corners_in_image_px, 0.0};
    for (const MarkerPose& pose :
         EstimateMarkerPoses(camera, detection.corners_in_image_px, length_m)) {
      MarkerPoints x_in_cam;
      x_in_cam[0] = pose.cam_from_marker.translation;
      for (int i = 0; i < kNumCorners; ++i) {
        x_in_cam[i + 1] = pose.cam_from_marker * corners_in_marker[i];
      }
      marker.x_in_cam.push_back(x_in_cam);
    }
    if (marker.x_in_cam.empty()) continue;
    const double distance_m = marker.x_in_cam.front()[0].norm();
    marker.depth_sigma_m =
        distance_m * distance_m * kCornerSigmaPx / (MeanFocalLength(camera) * length_m);
    frame.markers.push_back(std::move(marker));
  }
  return frame;
}

}  // namespace velamap
