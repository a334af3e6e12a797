// Finds markers that contradict the layout. A false quad with a valid code that is detected in the
// same place in a few images fits these images as well as a true marker does. Only prior knowledge
// of the object exposes it: markers do not overlap, the markers of a line are about evenly spaced,
// and a marker is seen in most images that should show it.
//
// All tests are relative: they compare lengths with the distances between neighbours or with the
// extent of a part, and how often a marker is seen with how often its neighbours are.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/layout/layout.h"

namespace velamap {

// A reconstructed marker and the images that support it.
struct PlacedMarker {
  int marker_id = 0;
  Eigen::Vector3d center_in_shape_m = Eigen::Vector3d::Zero();
  // Sigma of the centre in its least certain direction. Each image counts as if it showed only one
  // corner, because errors of the pose, the lens and the cloth move all four corners together.
  double sigma_m = 0.0;
  int num_seen = 0;  // images in which it is detected at this place
  // Images that should show it, because it projects into them, faces the camera and is as large as
  // in the images where it is detected. It is detected in `num_seen_of_these` of them.
  int num_should_see = 0;
  int num_seen_of_these = 0;
  // Ascending ids of the markers that are in the same place in all images that show this one. One
  // of the two ids is then misread.
  std::vector<int> rival_ids;
};

struct Contradiction {
  int marker_id = 0;
  std::string reason;
};

// Returns the contradicted markers by ascending id. `markers` are by ascending id, each once.
//
// - If two markers claim one place, the one that undisputed markers of its lines confirm is kept,
//   or else the one that more than twice as many images show. If neither test decides, both are
//   contradicted.
// - On every line, line_evidence.h finds the markers that cannot be on it. A marker on several
//   lines is contradicted only if it cannot be on any of them. On a line of two, a marker that
//   another line confirms judges the other one.
// - A marker that no line can judge is contradicted if it is seen much less often than the others
//   and its distance from them exceeds twice their extent.
std::vector<Contradiction> FindContradictions(const Layout& layout,
                                              const std::vector<PlacedMarker>& markers);

}  // namespace velamap
