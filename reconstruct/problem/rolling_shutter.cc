#include "reconstruct/problem/rolling_shutter.h"

#include <algorithm>
#include <cmath>

#include <ceres/jet.h>

namespace velamap {

RowMotion RowMotionOf(const Camera& camera, const Eigen::Vector2d& x_in_image_px,
                      const CornerMotion& motion) {
  // Sensors are wider than high.
  const bool is_portrait = camera.height_px > camera.width_px;
  RowMotion result;
  result.row_by_px[is_portrait ? 0 : 1] = 1.0 / std::min(camera.width_px, camera.height_px);
  result.row = result.row_by_px.dot(x_in_image_px) - 0.5;
  result.motion = motion;
  return result;
}

RowShift ShiftByRow(const RowMotion& motion, double rolling_shutter_s) {
  using Jet = ceres::Jet<double, 1>;
  using JetVector = Eigen::Matrix<Jet, 2, 1>;
  const Eigen::Vector2d& velocity_px_s = motion.motion.velocity_px_s;
  const Eigen::Vector2d& acceleration_px_s2 = motion.motion.acceleration_px_s2;
  const Eigen::Vector2d& jerk_px_s3 = motion.motion.jerk_px_s3;
  const Jet readout_s(rolling_shutter_s, 0);
  // A corner at frame time t is seen at t + readout * row(t): derivatives of that by t.
  const Jet time_rate = 1.0 + readout_s * motion.row_by_px.dot(velocity_px_s);
  const Jet time_acceleration_1_s = readout_s * motion.row_by_px.dot(acceleration_px_s2);
  const JetVector velocity = velocity_px_s.cast<Jet>() / time_rate;
  const JetVector acceleration =
      (acceleration_px_s2.cast<Jet>() - time_acceleration_1_s * velocity) / (time_rate * time_rate);
  const Jet time_jerk_1_s2 = readout_s * motion.row_by_px.dot(jerk_px_s3);
  const JetVector jerk =
      (jerk_px_s3.cast<Jet>() - 3.0 * time_rate * time_acceleration_1_s * acceleration -
       time_jerk_1_s2 * velocity) /
      (time_rate * time_rate * time_rate);
  const Jet since_middle_s = readout_s * motion.row;
  // From the motion at the corner's own row back to the middle row.
  const JetVector shift =
      since_middle_s *
      (velocity - since_middle_s * (0.5 * acceleration - since_middle_s / 6.0 * jerk));
  return {{shift.x().a, shift.y().a}, {shift.x().v[0], shift.y().v[0]}};
}

double ShiftSigma(const RowMotion& motion, double rolling_shutter_s) {
  return std::abs(rolling_shutter_s * motion.row) * motion.motion.velocity_sigma_px_s;
}

void MoveToMiddleRow(double rolling_shutter_s, const CornerMotions& motions, Model* model) {
  if (rolling_shutter_s == 0) return;
  for (ModelImage& image : model->images) {
    const auto of_image = motions.find(image.image_id);
    if (of_image == motions.end()) continue;
    const Camera& camera = model->cameras.at(image.camera_id);
    for (std::size_t i = 0; i < image.points2D.size(); ++i) {
      Eigen::Vector2d& x_px = image.points2D[i].x_in_image_px;
      x_px -=
          ShiftByRow(RowMotionOf(camera, x_px, of_image->second.at(i)), rolling_shutter_s).value_px;
    }
  }
}

}  // namespace velamap
