// The prior shape: where an earlier reconstruction of the surface has its markers.

#pragma once

#include <array>
#include <map>

#include <Eigen/Core>

#include "importer/base/ids.h"

namespace velamap {

// Corners 1..4 by marker id, in the shape frame, m. The scale may be arbitrary.
using PriorShape = std::map<int, std::array<Eigen::Vector3d, kNumCorners>>;

// How well the detections of frames agree with a prior shape. Frames with too few of its markers to
// decide do not count.
struct PriorShapeAgreement {
  int num_known = 0;     // detected markers that the prior shape holds
  int num_agreeing = 0;  // known markers that one camera pose of the frame explains

  PriorShapeAgreement& operator+=(const PriorShapeAgreement& other) {
    num_known += other.num_known;
    num_agreeing += other.num_agreeing;
    return *this;
  }
};

}  // namespace velamap
