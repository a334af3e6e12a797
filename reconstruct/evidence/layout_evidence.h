// Finds markers that the layout contradicts. A false quad with a legal code that is detected in the
// same place in a few images fits these images as well as a true marker does. Only knowledge about
// the object exposes it: markers do not overlap, neighbours on a line are about as far apart as the
// other markers on it, and most images that should show a marker do.
//
// All tests depend on ratios only: they compare lengths with the distances between neighbours or
// with the extent of a part, and numbers of images with the numbers for the neighbours.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/layout/layout.h"

namespace velamap {

// A marker with a place, and the images that support it.
struct PlacedMarker {
  int marker_id = 0;
  Eigen::Vector3d center_in_shape_m = Eigen::Vector3d::Zero();
  double sigma_m = 0.0;  // of the centre in its least certain direction
  int num_seen = 0;      // images that see it at this place
  // Images that should see it: it is inside, faces the camera and is as large in the image as it
  // usually is where it is seen. `num_seen_of_these` of them do.
  int num_should_see = 0;
  int num_seen_of_these = 0;
  // Ascending ids of the markers whose places explain all images that see this one. Either id may
  // be misread there.
  std::vector<int> rival_ids;
};

struct Contradiction {
  int marker_id = 0;
  std::string reason;
};

// `markers` by ascending id, each once. The result is by ascending id.
//
// - If two markers claim one place, the one that undisputed markers of its lines confirm stays;
//   otherwise the one that more than twice as many images see. If neither test decides, both go.
// - On every line, line_evidence.h finds the markers that cannot be on it. A marker on two lines is
//   believed if one of them holds it.
// - A marker that no line can judge is contradicted if hardly any image that should see it does and
//   if it lies farther from its part than twice the extent of that part.
std::vector<Contradiction> FindContradictions(const Layout& layout,
                                              const std::vector<PlacedMarker>& markers);

}  // namespace velamap
