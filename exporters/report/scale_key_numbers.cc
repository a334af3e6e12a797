#include "exporters/report/scale_key_numbers.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "exporters/datum/known_points_report.h"
#include "exporters/report/camera_key_numbers.h"
#include "exporters/scale/scale_audit_report.h"
#include "reconstruct/model/weak_geometry.h"

namespace velamap {
namespace {

constexpr double kGoodScaleSpread_percent = 1, kBadScaleSpread_percent = 3;
constexpr double kGoodScaleSigma_percent = 0.5, kBadScaleSigma_percent = 3;

// Whether a distance decides about the scale. A scale bar that is far from its length in the shape
// was left out by the adjustment.
bool DistanceDecides(const ScaleAudit& audit) {
  return std::any_of(audit.distances.begin(), audit.distances.end(),
                     [](const CheckedDistance& checked) {
                       return checked.distance_m && !checked.IsCheck() &&
                              std::abs(checked.DifferenceInSigmas()) <= kMaxCheckSigmas;
                     });
}

// Whether parts differ by more than the scale's sigma and no distance decides between them.
bool PartsLeaveScaleOpen(const ScaleEstimate& scale, const ScaleAudit& audit) {
  if (!audit.parts_disagree || DistanceDecides(audit)) return false;
  return std::any_of(audit.parts.begin(), audit.parts.end(), [&scale](const GroupScale& part) {
    return std::abs(part.deviation) > scale.relative_sigma.value_or(0.0);
  });
}

// 1 sigma of the scale; nothing if it is unknown.
std::optional<double> SigmaPercent(const ScaleEstimate& scale) {
  if (!scale.relative_sigma || std::isnan(*scale.relative_sigma)) return std::nullopt;
  return 100 * *scale.relative_sigma;
}

// The part of the sigma that no picture shows; empty if there is none.
std::string PrintText(const ScaleEstimate& scale) {
  if (!(scale.print_sigma > 0)) return "";
  return fmt::format(
      "; the first contains {:.3g} % that is assumed for the print until a distance is measured "
      "(common_print_tolerance)",
      100 * scale.print_sigma);
}

// How far the markers are from their lengths in the layout, if the model was adjusted with other
// lengths; empty if it was not, or if measured distances explain it.
std::string ContradictionOfLayout(const ScaleEstimate& scale, const ScaleAudit& audit) {
  constexpr double kMaxScaleSigmas = 3.0;
  const double sigma =
      std::hypot(scale.relative_sigma.value_or(0.0), audit.deviation_sigma.value_or(0.0));
  if (!(sigma > 0) || std::abs(audit.deviation) <= kMaxScaleSigmas * sigma ||
      DistanceDecides(audit)) {
    return "";
  }
  return fmt::format(
      "the markers are {:.2f} % {} than the layout says ({:.0f} sigmas), so the model was adjusted "
      "with other marker lengths",
      100 * std::abs(audit.deviation), audit.deviation < 0 ? "larger" : "smaller",
      std::abs(audit.deviation) / sigma);
}

// If the spread exceeds the noise of the corners, only the markers can cause it. Without sigmas of
// the corners, no other cause is known.
std::string SpreadAdvice(const ScaleAudit* audit, const std::vector<std::string>& warnings) {
  const bool is_noise_known =
      audit != nullptr && !audit->markers.empty() && audit->markers.front().sigma.has_value();
  if (!is_noise_known || 100 * audit->marker_spread > kGoodScaleSpread_percent) {
    return "the sizes of the markers contradict each other: check their prints and marker_length, "
           "and measure a distance (distances, use: scale)";
  }
  const auto weak = std::find_if(warnings.begin(), warnings.end(), IsWeakGeometryWarning);
  if (weak != warnings.end()) return *weak;
  return "the images determine single markers too poorly to compare their sizes: take more images, "
         "from closer and from places more than 30 degrees apart";
}

// A small spread proves nothing if the scale is hardly known: one marker never contradicts itself.
void JudgeScaleSigma(const ScaleEstimate& scale, KeyNumber* number) {
  const std::optional<double> sigma_percent = SigmaPercent(scale);
  const ReportStatus of_sigma =
      sigma_percent ? LowIsGood(*sigma_percent, kGoodScaleSigma_percent, kBadScaleSigma_percent)
                    : ReportStatus::kCheck;
  if (of_sigma <= number->status) return;
  number->status = of_sigma;
  if (sigma_percent) {
    number->advice =
        "the images do not determine the scale any better: measure a distance (distances, use: "
        "scale), or use larger markers with a wider white margin";
    return;
  }
  const std::string reason = scale.num_markers == 1
                                 ? "the size rests on one marker, so its error is unknown"
                                 : "the uncertainty of the size is unknown";
  number->meaning += "; " + reason;
  number->advice =
      reason + ": use more markers of known size, or measure a distance (distances, use: scale)";
}

}  // namespace

KeyNumber ScaleNumber(const ScaleEstimate& scale, const ScaleAudit* audit,
                      const AdjustmentUncertainty* uncertainty,
                      const std::vector<std::string>& warnings) {
  const double spread_percent = 100 * scale.relative_spread;
  std::string value = fmt::format("{:.2f} % spread", spread_percent);
  if (const auto sigma_percent = SigmaPercent(scale)) {
    value = fmt::format("\u00b1{:.3f} %, {}", *sigma_percent, value);
  }
  KeyNumber number{
      KeyNumberKind::kScale, value,
      fmt::format("standard deviations of the metric scale and of the scales from each of {} "
                  "markers alone; good up to {:g} % and {:g} % spread",
                  scale.num_markers, kGoodScaleSigma_percent, kGoodScaleSpread_percent) +
          PrintText(scale),
      LowIsGood(spread_percent, kGoodScaleSpread_percent, kBadScaleSpread_percent),
      SpreadAdvice(audit, warnings)};
  JudgeScaleSigma(scale, &number);
  const std::string contradiction =
      audit != nullptr && uncertainty != nullptr ? ContradictionOfLayout(scale, *audit) : "";
  if (audit != nullptr && !FailedChecks(*audit).empty()) {
    number.meaning += "; measured distances contradict it";
    number.status = ReportStatus::kBad;
    number.advice = "find out which is wrong, the measured distances or the shape, before using it";
  } else if (!contradiction.empty()) {
    number.meaning += "; " + contradiction;
    number.status = ReportStatus::kBad;
    number.advice = contradiction + ": adjust it again with this layout (bundle_adjuster)";
  } else if (audit != nullptr && number.status == ReportStatus::kGood &&
             PartsLeaveScaleOpen(scale, *audit)) {
    number.meaning += "; parts disagree: measure a distance on one of them";
    number.status = ReportStatus::kCheck;
    number.advice = "parts disagree: measure a distance on one of them (distances, use: scale)";
  }
  const bool is_calibration_doubted =
      uncertainty != nullptr && StatusOf(uncertainty->calibration) > ReportStatus::kGood;
  if (number.status == ReportStatus::kGood && is_calibration_doubted) {
    number.meaning += "; its sigma assumes a correct calibration, which is in doubt";
    number.status = ReportStatus::kCheck;
    number.advice =
        "its sigma assumes a correct calibration, which is in doubt: calibrate the camera first";
  }
  return number;
}

std::optional<KeyNumber> DistancesNumber(const ScaleAudit& audit) {
  if (audit.distances.empty()) return std::nullopt;
  const CheckedDistance* worst = WorstDistance(audit);
  const auto num_failed = static_cast<int>(FailedChecks(audit).size());
  const int num_found = NumDistancesFound(audit), num_checks = NumChecks(audit),
            num_all = static_cast<int>(audit.distances.size());
  KeyNumber number{KeyNumberKind::kMeasuredDistances,
                   num_failed > 0 ? fmt::format("{} of {} checks failed", num_failed, num_checks)
                                  : fmt::format("{} of {}", num_found, num_all),
                   fmt::format("{} of {} distances are in the shape, {} of them as checks of it; "
                               "good within {:g} sigmas of distance and shape together",
                               num_found, num_all, num_checks, kMaxCheckSigmas),
                   ReportStatus::kNone,
                   "find out whether a measured distance or the shape is wrong before using the "
                   "shape"};
  if (worst == nullptr) {
    number.status = ReportStatus::kCheck;
    return number;
  }
  number.value += ", worst " + ShortText(*worst);
  if (num_failed > 0) {
    number.status = ReportStatus::kBad;
  } else if (num_found < num_all || std::abs(worst->DifferenceInSigmas()) > kMaxCheckSigmas) {
    number.status = ReportStatus::kCheck;
  } else if (num_checks > 0) {
    number.status = ReportStatus::kGood;
  }
  return number;
}

std::optional<KeyNumber> KnownPointsNumber(const KnownPointFit& fit) {
  if (fit.points.empty()) return std::nullopt;
  KeyNumber number{
      KeyNumberKind::kKnownPoints, KnownPointsText(fit),
      fmt::format("points with measured coordinates; good if all are in the shape and agree, and "
                  "checks are within {:g} sigmas of point and shape together",
                  kMaxCheckSigmas),
      ReportStatus::kCheck,
      "find out whether measured coordinates or the shape are wrong before using the shape"};
  if (fit.is_contradicted || CountPoints(fit, PointState::kFailed) > 0) {
    number.status = ReportStatus::kBad;
  } else if (!fit.known_from_shape) {
    number.advice = "the result is in another frame: give more points, or film those given";
  } else if (fit.ContradictsScale()) {
    number.advice = "check marker_length, or measure a distance (distances, use: scale)";
  } else if (CountPoints(fit, PointState::kLeftOut) > 0) {
    number.advice = "check coordinates, ids and corners of the points left out";
  } else if (CountPoints(fit, PointState::kNotInShape) > 0) {
    number.advice = "some of them are not in the shape: film their markers";
  } else if (fit.residual_in_sigmas || CountPoints(fit, PointState::kPassed) > 0) {
    number.status = ReportStatus::kGood;
  } else {
    number.status = ReportStatus::kNone;  // nothing checks them
  }
  return number;
}

}  // namespace velamap
