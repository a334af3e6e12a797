// The prior shape: the positions of the markers in an earlier reconstruction of the surface.

#pragma once

#include <array>
#include <map>

#include <Eigen/Core>

#include "importer/base/ids.h"

namespace velamap {

// Corners 1..4 by marker id, in the frame of that reconstruction. The scale may be arbitrary.
using PriorShape = std::map<int, std::array<Eigen::Vector3d, kNumCorners>>;

// How well the detections in frames agree with a prior shape. Frames with too few of its markers
// for a decision do not count.
struct PriorShapeAgreement {
  int num_known = 0;     // detections of markers that the prior shape holds
  int num_agreeing = 0;  // of num_known: those that the camera pose of their frame explains

  PriorShapeAgreement& operator+=(const PriorShapeAgreement& other) {
    num_known += other.num_known;
    num_agreeing += other.num_agreeing;
    return *this;
  }
};

}  // namespace velamap
