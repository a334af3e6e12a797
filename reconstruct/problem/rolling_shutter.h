// How a rolling shutter displaces corners: the rows of a frame are read one after the other while
// the corners move. rolling_shutter_s is the readout time, from the first row to the last; the time
// of a frame is that of its middle row.

#pragma once

#include <Eigen/Core>

#include "reconstruct/model/model.h"
#include "reconstruct/registration/corner_motions.h"

namespace velamap {

// A corner while the rows of its frame are read.
struct RowMotion {
  double row = 0.0;  // of the corner: -0.5 for the first row of the frame, 0.5 for the last
  // Derivative of `row` with respect to the image point.
  Eigen::Vector2d row_by_px = Eigen::Vector2d::Zero();
  CornerMotion motion;
};

// In portrait frames, which are turned, the sensor's rows are the columns of the image, from left
// to right.
RowMotion RowMotionOf(const Camera& camera, const Eigen::Vector2d& x_in_image_px,
                      const CornerMotion& motion);

// How far the corner moves between the readout of the middle row and that of its own row, px, and
// the derivative with respect to rolling_shutter_s.
struct RowShift {
  Eigen::Vector2d value_px, by_shutter_px_s;
};

// Computes the shift to third order in the time between the two rows. The motion from frame to
// frame differs from that of the corner, because each frame shows the corner in another row and
// thus at another time within the frame.
RowShift ShiftByRow(const RowMotion& motion, double rolling_shutter_s);

// 1 sigma of a coordinate of the shift, px, due to that of the velocity.
double ShiftSigma(const RowMotion& motion, double rolling_shutter_s);

// Corrects the image points for the rolling shutter: moves each to its place at the time when the
// middle row is read.
void MoveToMiddleRow(double rolling_shutter_s, const CornerMotions& motions, Model* model);

}  // namespace velamap
