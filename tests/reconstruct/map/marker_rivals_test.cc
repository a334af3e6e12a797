#include <gtest/gtest.h>

#include "importer/geometry/units.h"
#include "reconstruct/geometry/marker_pose.h"
#include "reconstruct/map/map_intersection.h"

namespace velamap {
namespace {

// A marker of 100 mm at 5 m, tilted by `tilt_rad`, in two images from nearly the same place.
MarkerPlacement PlaceTiltedMarker(double tilt_rad) {
  const Camera camera{CameraModel::kPinhole, 2000, 1000, {2000, 2000, 1000, 500}};
  const Rigid3 shape_from_marker{
      Eigen::Quaterniond(Eigen::AngleAxisd(kPi - tilt_rad, Eigen::Vector3d::UnitX())), {0, 0, 5.0}};
  std::vector<DatabaseImage> images;
  std::vector<std::optional<Rigid3>> poses;
  for (const double x_m : {0.0, 0.02}) {
    poses.push_back(Rigid3{Eigen::Quaterniond::Identity(), {x_m, 0, 0}});
    MarkerDetection detection;
    detection.marker_id = 7;
    const auto corners = CornersInMarker(0.1);
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      detection.corners_in_image_px[i] =
          *ImageFromCam(camera, *poses.back() * (shape_from_marker * corners[i]));
    }
    DatabaseImage image;
    image.image_id = static_cast<ImageId>(images.size() + 1);
    image.camera_id = 1;
    image.detections.markers = {detection};
    images.push_back(image);
  }
  Layout layout;
  layout.marker_length_m = 0.1;
  const std::map<CameraId, Camera> cameras = {{1, camera}};
  const MapProblem problem = MakeMapProblem({&images[0], &images[1]}, cameras, layout);
  MapSolution solution = EmptySolution(problem);
  solution.cam_from_shape = poses;
  return PlaceMarker(problem, solution, 0, 1.0);
}

// Views from one direction do not decide between the planar solutions, which differ by twice the
// tilt.
TEST(PlaceMarker, KeepsBothPlanarSolutionsOfAMarkerTiltedByTenDegrees) {
  const MarkerPlacement placement = PlaceTiltedMarker(0.17);
  ASSERT_EQ(placement.places.size(), 2u);
  const double angle = placement.places[0].shape_from_marker.rotation.angularDistance(
      placement.places[1].shape_from_marker.rotation);
  EXPECT_GT(angle, 0.2);
  EXPECT_LT(angle, 0.39);
}

TEST(PlaceMarker, TakesPlanarSolutionsOfAMarkerThatFacesTheCameraAsOne) {
  EXPECT_EQ(PlaceTiltedMarker(0.05).places.size(), 1u);
}

}  // namespace
}  // namespace velamap
