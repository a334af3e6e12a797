// The shape of the surface by an earlier reconstruction.

#pragma once

#include <array>
#include <map>

#include <Eigen/Core>

#include "importer/base/ids.h"

namespace velamap {

// Corners 1..4 by marker id, in the shape frame, m. Another scale serves as well.
using MarkerMap = std::map<int, std::array<Eigen::Vector3d, kNumCorners>>;

// How well the detections of frames agree with a map. Frames with too few markers of the map to
// decide do not count.
struct MapAgreement {
  int num_known = 0;     // detected markers that the map holds
  int num_agreeing = 0;  // those of them that one camera pose of the frame explains

  MapAgreement& operator+=(const MapAgreement& other) {
    num_known += other.num_known;
    num_agreeing += other.num_agreeing;
    return *this;
  }
};

}  // namespace velamap
