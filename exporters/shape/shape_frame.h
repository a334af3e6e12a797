// The frame of the result: one that means something on the boat, and the same in every clip of it.
//
//   x_in_frame = frame_from_shape * x_in_shape, right-handed
//
// By markers:        origin, x towards the axis marker, the plane marker where y = 0 and z > 0.
// By reference part: origin at the mean of its marker centres. Its axes are the normal of the
//                    least-squares plane of its corners, the direction from its first to its last
//                    marker within that plane, and the third at right angles; for a part that is
//                    no flat thing (less than twice as wide as thick) the mean normal of its
//                    markers stands for the plane's, and the line is taken as it is. z is the one
//                    of them (and the sense) that is nearest to the sail's up, x of the other two
//                    the one nearest to luff-to-leech; without lines the markers' own up, and first
//                    to last. The sail only picks axes, it never turns them: the frame is the
//                    hull's.
// By lines:          origin at the luff marker of the lowest horizontal line, x to its leech
//                    marker, z up at right angles to x in the plane of x and a vertical line (from
//                    its first to its last marker); without a vertical line, from the middle of the
//                    lowest to the middle of the highest horizontal line.
// Camera:            the model's frame as it is; velamap puts the central camera there.
//
// With x from luff to leech and z up, y = z x x is to starboard of a sail whose luff is forward: to
// leeward on port tack, to windward on starboard tack. No right-handed frame has all three, and a
// mirrored one would not hold cameras. The description says on which side leeward is; sections
// count depth and twist to leeward in either case.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/frame_choice.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct ShapeFrame {
  FrameKind kind = FrameKind::kCamera;
  Rigid3 frame_from_shape;
  // Holds all that the frame is made of: two results with the same name are in the same frame, as
  // long as the named markers have not moved on the boat.
  std::string name = "camera";
  std::string description;           // origin and axes in words
  std::vector<std::string> reasons;  // why the frames that come before it could not be made
  // Unit vector in the frame: z, or for the camera what the lines say; nothing without lines.
  std::optional<Eigen::Vector3d> up_in_frame;
};

// One line for files: `name: description; reasons`.
std::string FrameText(const ShapeFrame& frame);

// The first that the whole markers allow: `choice` if given, else what the layout's `frame` says,
// then the reference part, the lines, the camera. Never fails: the camera is always there.
ShapeFrame ChooseFrame(const MarkerShape& shape, const Layout& layout,
                       const std::optional<FrameChoice>& choice = std::nullopt);

// The covariance in the frame: turned, for a shift changes none. It stays relative to the datum of
// the adjustment; the frame's own uncertainty is not added.
PointCovariance RotateCovariance(const Eigen::Quaterniond& frame_from_shape,
                                 const PointCovariance& covariance);

// Moves the shape into the frame. The sigmas along the new axes come from `covariance_in_frame`;
// without it (null), or where it lacks a point, only equal sigmas along all axes survive a
// rotation: what the others become is not known.
void MoveShape(const Rigid3& frame_from_shape, const PointCovariance* covariance_in_frame,
               MarkerShape* shape);

// Moves points and cameras of a metric model into the frame.
void MoveModel(const Rigid3& frame_from_shape, Model* model);

}  // namespace velamap
