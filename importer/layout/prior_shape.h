// The prior shape: where an earlier reconstruction of the surface has its markers.

#pragma once

#include <array>
#include <map>

#include <Eigen/Core>

#include "importer/base/ids.h"

namespace velamap {

// Corners 1..4 of each marker, by its id, in the shape frame, m; any other scale does as well.
using PriorShape = std::map<int, std::array<Eigen::Vector3d, kNumCorners>>;

// How well the markers found in frames agree with a prior shape. Frames that show too few of its
// markers to tell are not counted.
struct PriorShapeAgreement {
  int num_known = 0;     // markers found that the prior shape holds
  int num_agreeing = 0;  // of these, those that one pose of their frame's camera explains

  PriorShapeAgreement& operator+=(const PriorShapeAgreement& other) {
    num_known += other.num_known;
    num_agreeing += other.num_agreeing;
    return *this;
  }
};

}  // namespace velamap
