// Identifiers that all rooms share.
//
// Marker corner c (1..4 = top-left, top-right, bottom-right, bottom-left of the upright marker) of
// marker k has the permanent COLMAP point id 10*k + c, so that it reads in the COLMAP GUI: point
// 793 is marker 79, corner 3. Corner 0 stands for the marker's centre, which is derived in 3D and
// never observed; it is no COLMAP point.

#pragma once

#include <array>
#include <cstdint>

#include "importer/base/error.h"

namespace velamap {

using CameraId = std::uint32_t;
using ImageId = std::uint32_t;
using Point3DId = std::uint64_t;

// What COLMAP stores for a 2D point that belongs to no 3D point.
constexpr Point3DId kInvalidPoint3DId = ~Point3DId{0};

constexpr int kNumCorners = 4;

// The largest marker id for which the identity-coding descriptors stay distinct
// (importer/database/correspondence.h); OpenCV's own dictionaries end at 1023.
constexpr int kMaxMarkerId = 8191;

struct CornerId {
  int marker_id = 0;
  int corner = 1;  // 1..4

  friend bool operator==(const CornerId& a, const CornerId& b) {
    return a.marker_id == b.marker_id && a.corner == b.corner;
  }
  friend bool operator<(const CornerId& a, const CornerId& b) {
    return a.marker_id != b.marker_id ? a.marker_id < b.marker_id : a.corner < b.corner;
  }
};

using Rgb = std::array<std::uint8_t, 3>;

inline Point3DId Point3DIdFromCorner(const CornerId& id) {
  VELAMAP_CHECK(id.marker_id >= 0 && id.corner >= 1 && id.corner <= kNumCorners);
  return 10 * static_cast<Point3DId>(id.marker_id) + static_cast<Point3DId>(id.corner);
}

// Whether a point id can be one of ours (its last digit is a corner).
inline bool IsCornerPoint3DId(Point3DId id) {
  return id % 10 >= 1 && id % 10 <= kNumCorners && id / 10 <= static_cast<Point3DId>(kMaxMarkerId);
}

inline CornerId CornerFromPoint3DId(Point3DId id) {
  VELAMAP_CHECK(IsCornerPoint3DId(id));
  return {static_cast<int>(id / 10), static_cast<int>(id % 10)};
}

}  // namespace velamap
