// Pose of a single marker from its four corners (thesis section 3.3).
//
// IPPE for squares: Collins and Bartoli, "Infinitesimal plane-based pose estimation", IJCV 109(3),
// 2014, each solution refined by Levenberg-Marquardt. Where perspective is weak, two orientations
// explain the four corners of a square nearly equally well; both are kept, because only other views
// can decide.

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

// One or two poses, the one with the smaller reprojection error first. Empty if a corner
// has no ray or no pose is in front of the camera.
std::vector<MarkerPose> EstimateMarkerPoses(
    const Camera& camera, const std::array<Eigen::Vector2d, kNumCorners>& corners_in_image_px,
    double marker_length_m);

}  // namespace velamap
