#include "tests/support/clip/clip_camera.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>

#include "importer/geometry/look_at.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

// The phase of a swaying quantity. Phases are drawn in a fixed order, and the numbers of
// std::mt19937 are the same everywhere.
double DrawPhase(std::mt19937* random) { return 2 * kPi * ((*random)() / 4294967296.0); }

double Wave(double time_s, double period_s, double phase_rad) {
  return std::sin(2 * kPi * time_s / period_s + phase_rad);
}

// Fast turns of the camera about its three axes.
class Shake {
 public:
  Shake(double amplitude_deg, std::mt19937* random) : amplitude_rad_(kRadPerDeg * amplitude_deg) {
    for (double& phase : phases_) phase = DrawPhase(random);
  }

  Rigid3 CamFromCam(double time_s) const {
    Rigid3 turned;
    if (amplitude_rad_ == 0) return turned;
    constexpr double kPeriods_s[] = {0.43, 0.59, 0.71};
    for (int axis = 0; axis < 3; ++axis) {
      const double angle = amplitude_rad_ * Wave(time_s, kPeriods_s[axis], phases_[axis]);
      turned.rotation = turned.rotation * Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis));
    }
    return turned;
  }

 private:
  double amplitude_rad_;
  double phases_[3];
};

}  // namespace

Camera MakeClipCamera(bool wide_angle, int width_px) {
  const double scale = width_px / 3840.0;
  const double center_x = scale * (1920 + 9), center_y = scale * (1080 - 6);
  Camera camera{CameraModel::kOpenCV, width_px, width_px * 9 / 16, {}};
  if (wide_angle) {
    camera.params = {1750 * scale, 1750 * scale, center_x, center_y, -0.245, 0.07, 2e-4, -1e-4};
  } else {
    camera.params = {2840 * scale, 2840 * scale, center_x, center_y, 0.08, -0.12, -3e-4, 2e-4};
  }
  return camera;
}

CameraPath MakeOrbit(const ClipOptions& options, const Eigen::Vector3d& middle_m,
                     double camera_height_m, double own_drift_deg) {
  const double drift_deg = options.drift_deg > 0 ? options.drift_deg : own_drift_deg;
  std::mt19937 random(options.seed);
  const double turn = DrawPhase(&random), range = DrawPhase(&random), heave = DrawPhase(&random);
  const double pan = DrawPhase(&random), tilt = DrawPhase(&random), roll = DrawPhase(&random);
  const Shake shake(options.shake_deg, &random);
  return [=](double frame) {
    const double time_s = frame / options.fps;
    const double part = options.num_frames > 1 ? frame / (options.num_frames - 1.0) : 0.5;
    const double angle =
        kRadPerDeg * (options.angle_deg + drift_deg * (2 * part - 1) + 4 * Wave(time_s, 4.1, turn));
    const double distance_m = options.distance_m * (1 + 0.07 * Wave(time_s, 6.3, range));
    const Eigen::Vector3d position_m(
        middle_m.x() + distance_m * std::sin(angle), middle_m.y() - distance_m * std::cos(angle),
        camera_height_m + 0.04 * options.distance_m * Wave(time_s, 3.2, heave));
    const Eigen::Vector3d target_m =
        middle_m + 0.02 * options.distance_m *
                       Eigen::Vector3d(Wave(time_s, 2.7, pan), 0, Wave(time_s, 2.2, tilt));
    const Rigid3 calm = LookAt(position_m, target_m, 4 * kRadPerDeg * Wave(time_s, 3.7, roll));
    return shake.CamFromCam(time_s) * calm;
  };
}

CameraPath MakeBoardMotion(const ClipOptions& options) {
  std::mt19937 random(options.seed);
  const double phase_x = DrawPhase(&random), phase_y = DrawPhase(&random);
  const double phase_z = DrawPhase(&random);
  const bool upright = options.motion >= 'e';
  const int kind = (options.motion - 'a') % 4;  // at rest, about y, about x, about the centre
  const double still = 0.3, swing = 38;         // degrees
  const Shake shake(options.shake_deg, &random);
  return [=](double frame) {
    const double time_s = frame / options.fps;
    const double about_y =
        (kind == 1 || kind == 3 ? swing : still) * Wave(time_s, 4.3, phase_y) + options.angle_deg;
    const double about_x = (kind == 2 || kind == 3 ? swing : still) * Wave(time_s, 3.1, phase_x);
    const double about_z = (kind == 3 ? 60 : still) * Wave(time_s, 5.7, phase_z);
    const auto turned = [](double angle_deg, const Eigen::Vector3d& axis) {
      return Eigen::AngleAxisd(kRadPerDeg * angle_deg, axis);
    };
    const Rigid3 facing =
        LookAt({0, -options.distance_m, 0}, Eigen::Vector3d::Zero(), upright ? kPi / 2 : 0);
    Rigid3 pose;
    pose.rotation = turned(about_x, Eigen::Vector3d::UnitX()) *
                    turned(about_y, Eigen::Vector3d::UnitY()) *
                    turned(about_z, Eigen::Vector3d::UnitZ()) * facing.rotation;
    pose.translation = options.distance_m * Eigen::Vector3d(0.02 * Wave(time_s, 3.9, phase_x),
                                                            0.02 * Wave(time_s, 2.9, phase_y),
                                                            1 + 0.05 * Wave(time_s, 4.9, phase_z));
    return shake.CamFromCam(time_s) * pose;
  };
}

}  // namespace velamap
