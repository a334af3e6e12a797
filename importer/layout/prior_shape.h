// Where markers are on the surface, by an earlier reconstruction of it.

#pragma once

#include <array>
#include <map>

#include <Eigen/Core>

#include "importer/base/ids.h"

namespace velamap {

// Corners 1..4 of each marker, by its id, in the shape frame, m; any other scale does as well.
using MarkerMap = std::map<int, std::array<Eigen::Vector3d, kNumCorners>>;

// How far what is found in frames agrees with a map. Frames with too few markers of the map to tell
// do not count.
struct MapAgreement {
  int num_known = 0;     // markers found that the map holds
  int num_agreeing = 0;  // of these, those that one pose of their frame's camera explains

  MapAgreement& operator+=(const MapAgreement& other) {
    num_known += other.num_known;
    num_agreeing += other.num_agreeing;
    return *this;
  }
};

}  // namespace velamap
