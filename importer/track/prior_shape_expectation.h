// Expects missing markers where an earlier reconstruction of the surface reprojects, with the pose
// of the camera from the markers that are found.

#pragma once

#include <optional>
#include <vector>

#include "importer/camera/camera.h"
#include "importer/detect/marker_quad.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/prior_shape.h"
#include "importer/track/local_motion.h"

namespace velamap {

// The camera of a frame in the frame of the prior shape.
struct PriorShapeView {
  Rigid3 cam_from_shape;
  // How far the agreeing markers are found from their reprojections, because cloth moves; in
  // OpenCV's pixel frame.
  std::vector<PointMotion> departures;
};

// The pose by the consensus of the found markers that the prior shape holds (consensus_pose.h). Ids
// that are found twice are ignored. Returns nothing with fewer than kMinConsensus markers.
std::optional<PriorShapeView> PlaceInPriorShape(const PriorShape& prior_shape, const Camera& camera,
                                                const std::vector<MarkerQuad>& found,
                                                PriorShapeAgreement* agreement);

// Expects every marker of the prior shape that faces the camera and whose id is not found. Its
// place is its reprojection, shifted by the departures of the found markers around it. Leaves out
// markers that lie farther outside the image than their reach.
std::vector<ExpectedMarker> ExpectByPriorShape(const PriorShape& prior_shape, const Camera& camera,
                                               const PriorShapeView& view,
                                               const std::vector<MarkerQuad>& found);

}  // namespace velamap
