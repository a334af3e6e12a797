// Pose of a single marker from its four corners (thesis section 3.3).
//
// IPPE for squares: Collins and Bartoli, "Infinitesimal plane-based pose estimation", IJCV 109(3),
// 2014, each solution refined by Levenberg-Marquardt. Two orientations explain four corners of a
// plane nearly equally well where perspective is weak; both are kept, because only other views can
// tell.

#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "importer/base/ids.h"
#include "importer/camera/camera.h"
#include "importer/geometry/rigid3.h"

namespace velamap {

struct MarkerPose {
  Rigid3 cam_from_marker;  // m
  double rms_error_px = 0.0;
};

// Corners 1..4 in the marker frame (x right, y up, z out of the face), m.
std::array<Eigen::Vector3d, kNumCorners> CornersInMarker(double marker_length_m);

// One or two poses, the one with the smaller reprojection error first. Empty when a corner's ray
// cannot be found or no pose lies in front of the camera.
std::vector<MarkerPose> EstimateMarkerPoses(
    const Camera& camera, const std::array<Eigen::Vector2d, kNumCorners>& corners_in_image_px,
    double marker_length_m);

}  // namespace velamap
