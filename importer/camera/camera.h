// COLMAP camera models and the projection between the cam and image frames.
//
// Frames: cam is x right, y down, z forward; image is COLMAP's, in px, with (0,0) at the top-left
// corner of the image and the first pixel's centre at (0.5, 0.5). Parameters are ordered as in
// COLMAP 3.8 (src/base/camera_models.h); the distortion polynomials are Brown-Conrady's, the
// rational extension of OpenCV, and the equidistant fisheye of OpenCV's fisheye module.

#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace velamap {

// Added to OpenCV's image positions, in x and in y: OpenCV has (0,0) at the centre of the first
// pixel.
inline constexpr double kImageFromOpenCvPx = 0.5;

// Values are COLMAP's model ids.
enum class CameraModel {
  kSimplePinhole = 0,  // f, cx, cy
  kPinhole = 1,        // fx, fy, cx, cy
  kSimpleRadial = 2,   // f, cx, cy, k1
  kRadial = 3,         // f, cx, cy, k1, k2
  kOpenCV = 4,         // fx, fy, cx, cy, k1, k2, p1, p2
  kOpenCVFisheye = 5,  // fx, fy, cx, cy, k1, k2, k3, k4
  kFullOpenCV = 6,     // fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6
};

struct Camera {
  CameraModel model = CameraModel::kPinhole;
  int width_px = 0;
  int height_px = 0;
  std::vector<double> params;

  friend bool operator==(const Camera& a, const Camera& b) {
    return a.model == b.model && a.width_px == b.width_px && a.height_px == b.height_px &&
           a.params == b.params;
  }
};

// The larger side of the image, px.
inline int LargerSide(const Camera& camera) { return std::max(camera.width_px, camera.height_px); }

// COLMAP's names are upper case. An unknown name or id yields nothing.
std::string CameraModelName(CameraModel model);
std::optional<CameraModel> CameraModelFromName(const std::string& name);
std::optional<CameraModel> CameraModelFromId(int model_id);
int NumCameraParams(CameraModel model);

// A guess at an uncalibrated camera: SIMPLE_RADIAL without distortion, with the principal point in
// the centre. `focal_px` is the focal length if it is roughly known; 0 gives COLMAP's guess of 1.2
// times the larger side.
Camera UnknownCamera(int width_px, int height_px, double focal_px = 0.0);

// Mean of the focal lengths in x and y, px.
double MeanFocalLength(const Camera& camera);

// The smaller of the focal lengths in x and y, px.
double SmallestFocalLength(const Camera& camera);

// Projects a point into the image (px). Returns nothing for a point that is not in front of the
// camera.
std::optional<Eigen::Vector2d> ImageFromCam(const Camera& camera, const Eigen::Vector3d& x_in_cam);

// Returns the undistorted ray (x/z, y/z) of an image position in the cam frame, by Newton's method
// to 1e-12. Returns nothing if the distortion cannot be inverted, far outside the image.
std::optional<Eigen::Vector2d> CamFromImage(const Camera& camera,
                                            const Eigen::Vector2d& x_in_image_px);

// Distance of the image's farthest corner from the optical axis, as a tangent (the length of the
// undistorted ray). If the distortion cannot be inverted there, the length of the distorted ray.
double MaxRayLength(const Camera& camera);

// Whether rays farther from the optical axis are seen farther from the principal point, in every
// direction and up to the image's border. If they are not, the distortion folds over and belongs
// to no lens.
bool HasMonotonicDistortion(const Camera& camera);

}  // namespace velamap
