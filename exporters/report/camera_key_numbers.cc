#include "exporters/report/camera_key_numbers.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "reconstruct/model/weak_geometry.h"

namespace velamap {
namespace {

// Limits of how far the calibration that fits the residuals best would move the shape, in sigmas
// that assume that the given calibration is right.
constexpr double kGoodShapeChange_sigmas = 0.5, kBadShapeChange_sigmas = 1;
// A parameter is named alone if it explains at least this share of what all parameters explain.
constexpr double kDecisiveShare = 0.7;

}  // namespace

ReportStatus LowIsGood(double value, double good, double bad) {
  if (value <= good) return ReportStatus::kGood;
  return value <= bad ? ReportStatus::kCheck : ReportStatus::kBad;
}

std::string CalibrationAdvice(const CalibrationEvidence& evidence) {
  const bool is_focal = evidence.focal_share >= std::max(kDecisiveShare, evidence.distortion_share);
  const bool is_distortion = !is_focal && evidence.distortion_share >= kDecisiveShare;
  std::string what = "focal length and distortion";
  std::string command =
      "velamap automatic_reconstructor --BundleAdjustment.refine_focal_length 1 "
      "--BundleAdjustment.refine_extra_params 1";
  if (is_focal) {
    const double off_percent = 100 * (1 / (1 + evidence.focal_change) - 1);
    what = fmt::format("its focal length is {:.1f} % too {}", std::abs(off_percent),
                       off_percent > 0 ? "large" : "small");
    command = "velamap automatic_reconstructor --BundleAdjustment.refine_focal_length 1";
  } else if (is_distortion) {
    what = "its distortion is wrong or missing";
    command = "velamap automatic_reconstructor --BundleAdjustment.refine_extra_params 1";
  }
  return fmt::format(
      "the calibration {} these images ({}): calibrate this camera as it filmed (velamap "
      "camera_calibrator), or refine it: {}",
      StatusOf(evidence) == ReportStatus::kBad ? "does not belong to" : "does not quite fit", what,
      command);
}

std::string FoundCameraAdvice(const std::vector<std::string>& warnings) {
  const auto weak = std::find_if(warnings.begin(), warnings.end(), IsWeakGeometryWarning);
  if (weak != warnings.end()) return *weak;
  return "the camera that was found does not fit all pictures: film from more directions, with "
         "markers tilted and everywhere in the picture, or give a calibration, which velamap "
         "camera_calibrator makes";
}

ReportStatus StatusOf(const CalibrationEvidence& evidence) {
  if (evidence.num_changes == 0) return ReportStatus::kNone;
  if (!IsContradicted(evidence)) return ReportStatus::kGood;
  return LowIsGood(evidence.shape_change_in_sigmas, kGoodShapeChange_sigmas,
                   kBadShapeChange_sigmas);
}

std::optional<KeyNumber> CalibrationNumber(const ReportInput& input) {
  if (input.uncertainty == nullptr || input.uncertainty->calibration.num_changes == 0) {
    return std::nullopt;
  }
  const CalibrationEvidence& evidence = input.uncertainty->calibration;
  const bool is_found = !input.found_cameras.empty();
  return KeyNumber{
      KeyNumberKind::kCalibration,
      fmt::format("{}{:.3f} px systematic, {:.2g} sigmas of the shape",
                  is_found ? "found from the pictures, " : "", evidence.systematic_px,
                  evidence.shape_change_in_sigmas),
      fmt::format("part of the residuals and of the markers' sides over the image that another "
                  "calibration explains, and how far that would move the shape; good up to {:g} px "
                  "or {:g} sigmas",
                  kMaxSystematic_px, kGoodShapeChange_sigmas),
      StatusOf(evidence),
      is_found ? FoundCameraAdvice(input.warnings) : CalibrationAdvice(evidence)};
}

std::optional<KeyNumber> SteadinessNumber(const SteadinessVerdict& steadiness) {
  const auto number = [](std::string value, std::string advice, bool spoils_shape) {
    return KeyNumber{
        KeyNumberKind::kSteadiness, std::move(value),
        "change of the camera from picture to picture, which the sigmas of the shape "
        "do not include; bad if the principal point wanders by 1 % of the focal length "
        "or more, or the focal length jumps by 3 % or more",
        spoils_shape ? ReportStatus::kBad : ReportStatus::kCheck, std::move(advice)};
  };
  if (steadiness.wander) {
    const PrincipalPointWander& wander = *steadiness.wander;
    return number(fmt::format("principal point \u00b1{:.1f} % of the focal length",
                              100 * wander.spread_px / wander.focal_px),
                  DescribeWander(wander), wander.SpoilsShape());
  }
  if (steadiness.step) {
    const FocalStep& step = *steadiness.step;
    return number(fmt::format("focal length {:+.1f} %", 100 * (step.after_px / step.before_px - 1)),
                  DescribeStep(step), step.SpoilsShape());
  }
  return std::nullopt;
}

std::optional<KeyNumber> RollingShutterNumber(const AdjustmentUncertainty* uncertainty) {
  if (uncertainty == nullptr || !(uncertainty->rolling_shutter_sigma_s > 0)) return std::nullopt;
  return KeyNumber{KeyNumberKind::kRollingShutter,
                   fmt::format("{:.1f} \u00b1{:.1f} ms", 1e3 * uncertainty->rolling_shutter_s,
                               1e3 * uncertainty->rolling_shutter_sigma_s),
                   "time from the first row of a frame to the last, estimated from the video and "
                   "corrected in the shape",
                   ReportStatus::kNone};
}

std::optional<KeyNumber> FoundCameraNumber(const std::vector<EstimatedCamera>& cameras) {
  constexpr double kBad_percent = 5.0;
  const EstimatedCamera* worst = nullptr;
  double worst_percent = -1.0;
  for (const EstimatedCamera& found : cameras) {
    const double percent = FocalSigma_percent(found);
    if (percent <= worst_percent) continue;
    worst_percent = percent;
    worst = &found;
  }
  if (worst == nullptr) return std::nullopt;
  const std::string reason = WhyNotForOtherClips(*worst);
  return KeyNumber{
      KeyNumberKind::kCamera,
      fmt::format("found; focal length {:.1f} \u00b1 {:.1f} px", worst->camera.params.front(),
                  worst->sigmas.front()),
      fmt::format("found from the pictures without a calibration; good up to {:g} % of the focal "
                  "length, whose error the sigmas of the shape include; {}{}{}",
                  kGoodFocalSigma_percent, DescribeCamera(*worst, "\u00b1"),
                  reason.empty() ? "" : "; not good enough for other clips: ", reason),
      LowIsGood(worst_percent, kGoodFocalSigma_percent, kBad_percent),
      "the pictures hardly determine the camera: show markers tilted, everywhere in the picture "
      "and from more sides, or give a calibration"};
}

}  // namespace velamap
