// Where an earlier reconstruction of the surface says that markers should be visible: they are
// reprojected with the pose that the camera has by those that are found.

#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "importer/camera/camera.h"
#include "importer/detect/marker_quad.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/prior_shape.h"
#include "importer/track/local_motion.h"

namespace velamap {

// A frame's camera in the map.
struct MapView {
  Rigid3 cam_from_shape;
  // From where the map has an agreeing marker to where it is, OpenCV's pixel frame: cloth moves.
  std::vector<PointMotion> departures;
};

// By the consensus of the found markers that the map holds (consensus_pose.h). An id that is found
// twice says nothing, and neither is known nor agrees; a frame with fewer than kMinConsensus known
// ones has none.
std::optional<MapView> PlaceOnMap(const MarkerMap& map, const Camera& camera,
                                  const std::vector<MarkerQuad>& found, MapAgreement* agreement);

// Every marker of the map whose id is not found and which faces the camera: at its reprojection,
// moved as the found ones around it depart from theirs. None farther beyond the image's border than
// its reach.
std::vector<ExpectedMarker> ExpectOnMap(const MarkerMap& map, const Camera& camera,
                                        const MapView& view, const std::vector<MarkerQuad>& found);

}  // namespace velamap
