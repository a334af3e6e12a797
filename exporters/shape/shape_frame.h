// Chooses the frame of the result, so that all clips of one boat are in the same frame.
//
//   x_in_frame = frame_from_shape * x_in_shape, right-handed
//
// Markers:        origin at the first marker, x towards the axis marker; the plane marker has y = 0
//                 and z > 0.
// Reference part: origin at the mean of its marker centres. Three orthogonal directions belong to
//                 the part: the normal of the least-squares plane of its corners, the direction
//                 from its first to its last marker within that plane, and the third one. If the
//                 part is less than twice as wide as thick, the mean normal of its markers replaces
//                 that of the plane. z is the direction nearest to the sail's up, x the one of the
//                 other two that is nearest to luff-to-leech; without lines, the up of the markers
//                 and first-to-last decide. The sail only selects among the directions, so its trim
//                 does not rotate the frame.
// Lines:          origin at the luff marker of the lowest horizontal line, x to its leech marker, z
//                 up, orthogonal to x in the plane of x and a vertical line (from its first to its
//                 last marker) or, without one, the line from the middle of the lowest to the
//                 middle of the highest horizontal line.
// Known points:   the frame in which the layout's known points were measured, see
//                 exporters/datum/known_points.h.
// Camera:         the frame of the model; velamap puts the central camera there.
//
// With x from luff to leech and z up, y = z x x points to starboard of a sail whose luff is
// forward: to leeward on port tack, to windward on starboard tack. The frame stays right-handed
// because a mirrored one cannot hold cameras. The description says on which side leeward is;
// sections count depth and twist to leeward on both tacks.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/frame_choice.h"
#include "importer/layout/layout.h"

namespace velamap {

struct ShapeFrame {
  Rigid3 frame_from_shape;
  // Names everything that defines the frame: two results with the same name are in the same frame
  // if the named markers have not moved on the boat.
  std::string name = "camera";
  std::string description;           // origin and axes in words
  std::vector<std::string> reasons;  // why the preferred frames were not possible
  // Unit vector in the frame: z, or the sail's up for the camera; nothing without lines there.
  std::optional<Eigen::Vector3d> up_in_frame;
};

// A frame, or why there is none.
struct FrameAttempt {
  std::optional<ShapeFrame> frame;
  std::string reason;
};

// `name: description; reasons` in one line.
std::string FrameText(const ShapeFrame& frame);

// Throws InputError for a choice that no shape of this layout can grant: before the work.
void CheckFrameChoice(const std::optional<FrameChoice>& choice, const Layout& layout);

// Returns the frame that is `choice`, and throws InputError if the markers do not allow it. Without
// a choice, returns the first frame that the whole markers allow: the `frame` of the layout, the
// known points if it has some, the reference part, the lines, the camera. The camera is always
// possible. `known_points` is the frame of the known points in this shape.
ShapeFrame ChooseFrame(const MarkerShape& shape, const Layout& layout,
                       const std::optional<FrameChoice>& choice = std::nullopt,
                       const FrameAttempt& known_points = {});

}  // namespace velamap
