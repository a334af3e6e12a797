// Tells whether all images of a model were taken by one camera with an unchanged lens.
//
// The points stay where the model has them, and every image gets its own pose, focal length and
// principal point. A lens that was zoomed, a second camera and a stabilized picture, whose
// principal point wanders, show as values that scatter beyond their sigmas.

#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "reconstruct/model/model.h"

namespace velamap {

struct ImageIntrinsics {
  ImageId image_id = 0;
  // Relative to the model's camera: logarithm of the focal length, and offset of the principal
  // point, px; with 1 sigma each, by the image's own residuals.
  double log_focal = 0.0, log_focal_sigma = 0.0;
  Eigen::Vector2d offset_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d offset_sigma_px = Eigen::Vector2d::Zero();
  // The share of the squared errors of the image's corners, at its best pose, that is due to these
  // differences from the model's camera.
  double explained_share = 0.0;
};

// Returns an entry for each image that sees at least eight corners and determines its intrinsics.
std::vector<ImageIntrinsics> IntrinsicsOfImages(const Model& model);

// Two focal lengths, before and after an image, or of two groups of images that alternate.
struct FocalStep {
  std::string first_image_after;  // its name
  CameraId camera_id = 0;         // of that image
  double before_px = 0.0, after_px = 0.0;
  // Size of the step in its sigmas, which follow from those of the images or, if larger, from their
  // scatter. For two groups, whose images were chosen by their focal length, in units of the
  // scatter of a single image.
  double sigmas = 0.0;
  // For two groups: the images with the second focal length, which do not all follow the others,
  // and those with the first; other images are undecided. Both are empty for a step in time.
  std::set<ImageId> image_ids_after{}, image_ids_before{};

  bool IsInTime() const { return image_ids_after.empty(); }
  // Certain: at least 2 % and 8 sigmas. The points of the model were found with one focal length
  // and hide part of a step, so a smaller one (0.3 % and 3 sigmas) is suspicious: an adjustment
  // with two cameras has to confirm it.
  bool IsCertain() const;
  bool IsSuspicious() const;
  // 3 % or more. If the step is real, the errors of the shape exceed its sigmas, because these
  // assume one camera.
  bool SpoilsShape() const;
};

// A principal point that wanders from image to image.
struct PrincipalPointWander {
  double spread_px = 0.0;  // robust sigma along the axis that wanders more
  double focal_px = 0.0;

  // 1 % of the focal length or more. The errors of the shape then exceed its sigmas, because these
  // assume one camera.
  bool SpoilsShape() const;
};

struct SteadinessVerdict {
  // The step that divides the images best; none if there are few images. Two alternating groups
  // take precedence if they are at least five times as far apart as the images of a group scatter.
  // That ratio stays below five if the focal length is constant or changes slowly, as with the
  // focus (2.7 for a normal distribution, 4.1 for a sine).
  std::optional<FocalStep> step;
  // None unless the principal point wanders by at least 0.4 % of the larger side and 4 sigmas, and
  // this explains half of the errors. It explains a small part of those on flapping cloth, because
  // neighbouring corners share them.
  std::optional<PrincipalPointWander> wander;
};

// Takes the images in the natural order of their names.
SteadinessVerdict JudgeSteadiness(const Model& model);

// The verdict without a step that is not certain.
SteadinessVerdict WithoutDoubtfulStep(SteadinessVerdict verdict);

// Describes the finding as a warning with a remedy.
std::string DescribeStep(const FocalStep& step);
std::string DescribeWander(const PrincipalPointWander& wander);

}  // namespace velamap
