// The choice of the frame of the metric result. exporters/shape/shape_frame.h says how each frame
// is computed from markers.

#pragma once

#include <string>

namespace velamap {

enum class FrameKind {
  kMarkers,        // three named markers: origin, axis, plane
  kKnownPoints,    // the frame of the layout's known points
  kReferencePart,  // the layout's reference part, such as the hull
  kLines,          // the lowest horizontal line and a vertical line of the sail
  kCamera,         // the model's own frame, in which velamap puts the central camera
};

struct FrameChoice {
  FrameKind kind = FrameKind::kCamera;
  // For kMarkers only: the marker at the origin, the marker to which x points, and a marker in the
  // half plane of x and z with z > 0. All by their centres.
  int origin_id = -1, axis_id = -1, plane_id = -1;
};

// Parses "known_points", "reference_part", "lines", "camera", or the ids of origin, axis and plane
// such as "12,15,40". Throws InputError; `what` names the option.
FrameChoice ParseFrameChoice(const std::string& text, const std::string& what);

// Throws std::logic_error for kMarkers, which has no keyword.
std::string FrameKeyword(FrameKind kind);

// The inverse of FrameKeyword(). Returns false for any other text.
bool ParseFrameKeyword(const std::string& text, FrameKind* kind);

}  // namespace velamap
