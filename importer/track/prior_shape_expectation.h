// Where an earlier reconstruction of the surface says that markers should be visible: they are
// reprojected with the pose that the camera has by those that are found.

#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "importer/camera/camera.h"
#include "importer/detect/marker_quad.h"
#include "importer/layout/prior_shape.h"
#include "importer/track/local_motion.h"

namespace velamap {

// A frame's camera in the frame of the prior shape.
struct PriorShapeView {
  Eigen::Isometry3d cam_from_shape;
  // Of the agreeing markers, from their reprojection to where they are found, in OpenCV's pixel
  // frame: cloth moves.
  std::vector<PointMotion> departures;
};

// Finds the camera by the consensus of the markers that the prior shape holds (consensus_pose.h).
// An id that is found twice counts neither as known nor as agreeing. Nothing for a frame with fewer
// than kMinConsensus known markers.
std::optional<PriorShapeView> PlaceInPriorShape(const PriorShape& prior_shape, const Camera& camera,
                                                const std::vector<MarkerQuad>& found,
                                                PriorShapeAgreement* agreement);

// Every marker of the prior shape that is not found and faces the camera: at its reprojection,
// moved as the found markers around it depart from theirs. None lies farther beyond the image's
// border than its reach.
std::vector<ExpectedMarker> ExpectByPriorShape(const PriorShape& prior_shape, const Camera& camera,
                                               const PriorShapeView& view,
                                               const std::vector<MarkerQuad>& found);

}  // namespace velamap
