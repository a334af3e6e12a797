// The prior that a calibration file gives for the parameters of its camera, and how far an
// adjustment may depart from it.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/camera/camera.h"

namespace velamap {

// The groups of parameters that an adjustment estimates.
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

// Independent normal priors of the camera parameters, in COLMAP's order.
struct IntrinsicsPrior {
  CameraModel model = CameraModel::kPinhole;
  double max_ray_length = 0.0;  // MaxRayLength
  std::vector<double> mean;
  std::vector<double> sigmas;  // of all parameters
  std::vector<int> free;       // ascending indices of the parameters that are estimated
  std::vector<int> held;       // ascending indices of the others, which stay constant
};

// The prior with `calibration` as its mean. Distortion parameters of a FULL_OPENCV camera that are
// zero stay zero, because its calibration does not give them: one that was read from five
// coefficients has no k4, k5 and k6. If these were free, numerator and denominator would cancel
// each other and diverge.
//
// `sigma` is a fraction. The sigma of the focal length and of the principal point is this fraction
// of the focal length. 1 sigma of a distortion parameter moves the image's farthest corner by this
// fraction of its distance from the optical axis.
IntrinsicsPrior MakeIntrinsicsPrior(const Camera& calibration, const FreeIntrinsics& free,
                                    double sigma);

// The prior of a camera without a calibration. The focal length of `camera` is the mean and also
// the sigma, so that nearly any focal length is possible. The principal point is in the centre with
// a sigma of 2 % of the larger side. The mean distortion is zero; 1 sigma of a radial parameter
// moves the image's farthest corner by 30 %, and 1 sigma of a tangential one by 1 %. All parameters
// are free except the denominator of FULL_OPENCV, which would diverge together with the numerator.
// Only the model, the size and the focal length of `camera` matter.
IntrinsicsPrior UnknownCameraPrior(const Camera& camera);

// 1 sigma of the relative difference between the two focal lengths of a camera without a
// calibration. It is small because sensors have square pixels.
constexpr double kPixelShapeSigma = 1e-3;

// Whether the calibration has distortion parameters that its file does not give: those of a
// FULL_OPENCV camera that are zero.
bool HasUnspecifiedDistortion(const Camera& calibration);

// Adds distortion parameters of zero to a pinhole camera: PINHOLE becomes OPENCV, and
// SIMPLE_PINHOLE becomes SIMPLE_RADIAL. Returns other cameras unchanged.
Camera WithDistortionParams(const Camera& camera);

// The groups of `free` that the images determine clearly better than the calibration does.
// `refined` is the estimate, and `covariance` is the covariance of its free parameters, in the
// order of `prior.free`. A group passes if the sigma of the estimate is at most a third of the
// prior's sigma, or of the change from the prior's mean if that is larger. For the focal lengths,
// and for the coordinates of the principal point, the largest sigma is compared with the largest
// change, both as multiples of the prior's sigmas. The distortion is judged by how far it moves a
// ray radially, at 0.7 of the way to the image's farthest corner; the prior's sigma is then the one
// that its first parameter causes there.
//
// No group passes if the ratio of the focal lengths changes by more than a third of the prior's
// sigma: the pixels of a sensor keep their shape, so such a change is an effect of a rolling
// shutter, which compresses or stretches the image along its columns.
FreeIntrinsics DeterminedIntrinsics(const FreeIntrinsics& free, const IntrinsicsPrior& prior,
                                    const Camera& refined, const Eigen::MatrixXd& covariance);

// Whether the focal lengths and the principal point are within 1 sigma of the prior's mean, and the
// distortion moves a ray at 0.7 of the way to the image's farthest corner by no more than 1 sigma
// of its first parameter would.
bool IsWithin(const IntrinsicsPrior& prior, const Camera& camera);

// Describes in a message what has changed: "focal length 901.3 -> 875.1 px, ...". Both cameras have
// the same model.
std::string DescribeRefinement(const Camera& calibration, const Camera& refined);

}  // namespace velamap
