// What a calibration file says about the parameters of its camera, and how far an adjustment may
// move them.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/camera/camera.h"

namespace velamap {

// Groups of parameters that an adjustment frees.
struct FreeIntrinsics {
  bool focal_length = false;
  bool principal_point = false;
  bool distortion = false;

  bool Any() const { return focal_length || principal_point || distortion; }
  friend bool operator==(const FreeIntrinsics& a, const FreeIntrinsics& b) {
    return a.focal_length == b.focal_length && a.principal_point == b.principal_point &&
           a.distortion == b.distortion;
  }
};

// Normal prior of the parameters, in COLMAP's order.
struct IntrinsicsPrior {
  CameraModel model = CameraModel::kPinhole;
  double max_ray_length = 0.0;  // MaxRayLength
  std::vector<double> mean;
  std::vector<double> sigmas;  // of free and held parameters
  std::vector<int> free;       // indices of the parameters that may change, ascending
  std::vector<int> held;       // all others, ascending
};

// The prior around `calibration`. A distortion parameter is free only where the calibration names
// it: a FULL_OPENCV camera that was read from five coefficients has no k4 k5 k6, and those that are
// zero in it stay zero. Without this, numerator and denominator cancel each other and run away.
//
// `sigma` is a fraction: of the focal length for the focal length and the principal point; each
// distortion parameter moves the image's farthest corner by that fraction of its distance from the
// optical axis.
IntrinsicsPrior MakeIntrinsicsPrior(const Camera& calibration, const FreeIntrinsics& free,
                                    double sigma);

// The prior of a camera that nobody calibrated: any focal length (a normal prior around the one of
// `camera`, whose sigma is that focal length itself), the principal point in the centre with a
// sigma of 2 % of the larger side, and no distortion. 1 sigma of each radial parameter moves the
// image's farthest corner by 30 %, 1 sigma of each tangential one by 1 %. All parameters are free
// except the denominator of FULL_OPENCV, which would run away with the numerator. Depends only on
// the model, the size and the focal length of `camera`.
IntrinsicsPrior UnknownCameraPrior(const Camera& camera);

// 1 sigma of the relative difference of the two focal lengths of a camera that nobody calibrated:
// sensors have square pixels.
constexpr double kPixelShapeSigma = 1e-3;

// Whether the calibration has distortion parameters that its file does not name.
bool HasUnnamedDistortion(const Camera& calibration);

// Gives a pinhole camera the parameters of radial distortion, all zero: PINHOLE becomes OPENCV,
// SIMPLE_PINHOLE becomes SIMPLE_RADIAL. Other cameras stay as they are.
Camera WithDistortionParams(const Camera& camera);

// The groups of `free` that the images determine clearly better than the calibration does.
// `refined` is the estimate of the prior's free parameters and `covariance` its covariance. The
// test looks at every focal length, both coordinates of the principal point, and the radial
// distortion at 0.7 of the way to the image's farthest corner: the sigma must be at most a third of
// the prior's (for the distortion, of one parameter's), or of the group's change where this is
// larger and contradicts the prior.
//
// None where the ratio of the focal lengths changes by more than a third of the prior's sigma: the
// pixels of a sensor keep their shape, but a rolling shutter squeezes rows.
FreeIntrinsics DeterminedIntrinsics(const FreeIntrinsics& free, const IntrinsicsPrior& prior,
                                    const Camera& refined, const Eigen::MatrixXd& covariance);

// Whether the focal lengths and the principal point are within 1 sigma of the prior, and the radial
// distortion at 0.7 of the way to the image's farthest corner has changed by no more than 1 sigma
// of its first parameter would change it.
bool IsWithin(const IntrinsicsPrior& prior, const Camera& camera);

// What has changed, for a message: "focal length 901.3 -> 875.1 px, ...".
std::string DescribeRefinement(const Camera& calibration, const Camera& refined);

}  // namespace velamap
