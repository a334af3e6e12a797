// The choice of the coordinate frame of the metric result. exporters/shape/shape_frame.h defines
// how each frame is computed from the markers.

#pragma once

#include <string>

namespace velamap {

enum class FrameKind {
  kMarkers,        // three markers that give origin, axis and plane
  kKnownPoints,    // the frame in which the layout's known points were measured
  kReferencePart,  // the layout's reference part, such as the hull
  kLines,          // the lowest horizontal line and a vertical line of the sail
  kCamera,         // the model's own frame, in which velamap puts the central camera
};

struct FrameChoice {
  FrameKind kind = FrameKind::kCamera;
  // For kMarkers only: the ids of the marker at the origin, of a marker on the positive x axis, and
  // of a marker in the plane of x and z with z > 0. The centres of the markers count.
  int origin_id = -1, axis_id = -1, plane_id = -1;
};

// Parses "known_points", "reference_part", "lines", "camera", or the ids of origin, axis and plane,
// such as "12,15,40". Throws InputError that begins with `what`, the name of the option.
FrameChoice ParseFrameChoice(const std::string& text, const std::string& what);

// Throws std::logic_error for kMarkers, which has no keyword.
std::string FrameKeyword(FrameKind kind);

// The inverse of FrameKeyword(). Returns false for any other text.
bool ParseFrameKeyword(const std::string& text, FrameKind* kind);

}  // namespace velamap
