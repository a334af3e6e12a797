// Identifiers that all rooms share.
//
// Marker corner c (1..4 = top-left, top-right, bottom-right, bottom-left of the upright marker) of
// marker k has the permanent COLMAP point id 10*k + c, which can be read in the COLMAP GUI: point
// 793 is corner 3 of marker 79. Corner 0 stands for the marker's centre, which is derived from the
// corners in 3D; it is never observed and is not a COLMAP point.

#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "importer/base/error.h"

namespace velamap {

using CameraId = std::uint32_t;
using ImageId = std::uint32_t;
using Point3DId = std::uint64_t;

// COLMAP stores this for a 2D point without a 3D point.
constexpr Point3DId kInvalidPoint3DId = ~Point3DId{0};

constexpr int kNumCorners = 4;

// Up to this marker id the descriptors of importer/database/correspondence.h are distinct. OpenCV's
// own dictionaries end at 1023.
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

// The marker of that id in a list by ascending id; null without one.
template <typename Marker>
const Marker* FindMarkerById(const std::vector<Marker>& markers, int marker_id) {
  const auto it =
      std::lower_bound(markers.begin(), markers.end(), marker_id,
                       [](const Marker& marker, int id) { return marker.marker_id < id; });
  return it != markers.end() && it->marker_id == marker_id ? &*it : nullptr;
}

using Rgb = std::array<std::uint8_t, 3>;

inline Point3DId Point3DIdFromCorner(const CornerId& id) {
  VELAMAP_CHECK(id.marker_id >= 0 && id.corner >= 1 && id.corner <= kNumCorners);
  return 10 * static_cast<Point3DId>(id.marker_id) + static_cast<Point3DId>(id.corner);
}

// Whether the id has the form 10*k + c.
inline bool IsCornerPoint3DId(Point3DId id) {
  return id % 10 >= 1 && id % 10 <= kNumCorners && id / 10 <= static_cast<Point3DId>(kMaxMarkerId);
}

inline CornerId CornerFromPoint3DId(Point3DId id) {
  VELAMAP_CHECK(IsCornerPoint3DId(id));
  return {static_cast<int>(id / 10), static_cast<int>(id % 10)};
}

}  // namespace velamap
