#include "exporters/report/report_key_numbers.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "exporters/report/camera_key_numbers.h"
#include "exporters/report/scale_key_numbers.h"
#include "importer/base/statistics.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

// Limits of the verdicts. Correct reconstructions have reprojection errors of 0.1 to 0.3 px, wrong
// shapes that nevertheless register 0.8 px and more. Prints and corners are accurate to about 1 %
// of an area; the area of a bent or misread marker is wrong by several percent.
constexpr double kGoodError_px = 0.5, kBadError_px = 0.8;
// Blur, compression and bent prints make the errors up to three times as large as the noise of the
// corners. If they are larger, something moved that the model takes to be at rest.
constexpr double kGoodNoiseFactor = 4.0;
constexpr double kGoodAreaError_percent = 2, kBadAreaError_percent = 5;
constexpr double kGoodRatio = 0.95, kBadRatio = 0.7;
// The codes that a wrong dictionary finds do not fit together, but some do by chance.
constexpr double kGoodIdShare = 0.5, kBadIdShare = 0.25;

ReportStatus HighIsGood(double value, double good, double bad) {
  return LowIsGood(-value, -good, -bad);
}

KeyNumber MarkersNumber(const ShapeMetrics& metrics) {
  KeyNumber number{KeyNumberKind::kMarkers, fmt::format("{}", metrics.num_markers),
                   "markers with all four corners reconstructed", ReportStatus::kNone};
  if (metrics.reconstruction_ratio) {
    const double ratio = *metrics.reconstruction_ratio;
    number.value = fmt::format("{} of {}, {:.1f} %", metrics.NumWholeOfLayout(),
                               metrics.num_layout_markers.value_or(0), 100 * ratio);
    number.meaning = fmt::format(
        "of the layout's markers with all four corners reconstructed; good from {:.0f} %",
        100 * kGoodRatio);
    number.status = HighIsGood(ratio, kGoodRatio, kBadRatio);
    number.advice =
        "see in the report why the others were left out: film them closer, from more places, or "
        "correct the layout";
  }
  return number;
}

// How many of the ids found fit into one shape.
std::optional<KeyNumber> DictionaryNumber(const ReportInput& input) {
  if (input.num_ids_found == 0) return std::nullopt;
  const auto num_fitting = static_cast<int>(input.shape.markers.size());
  return KeyNumber{
      KeyNumberKind::kDictionary, fmt::format("{} of {} ids fit", num_fitting, input.num_ids_found),
      fmt::format("ids found in the images that are part of the shape; good from {:.0f} %",
                  100 * kGoodIdShare),
      HighIsGood(static_cast<double>(num_fitting) / input.num_ids_found, kGoodIdShare, kBadIdShare),
      "the others contradict each other or are seen only once, which happens with a wrong "
      "dictionary: check the dictionary, its border_bits and whether the prints are inverted"};
}

KeyNumber ImagesNumber(const ReportInput& input) {
  const std::size_t num_used = input.metric_model.images.size();
  const std::size_t num_all =
      num_used + input.images_left_out.size() + input.images_not_needed.size();
  return {KeyNumberKind::kImages, fmt::format("{} of {}", num_used, num_all),
          num_used == num_all ? "used" : "used; the others are listed below with reasons",
          ReportStatus::kNone};
}

KeyNumber ErrorNumber(const Statistics& error_px, const AdjustmentUncertainty* uncertainty) {
  const double factor = uncertainty != nullptr ? std::sqrt(uncertainty->variance_factor) : 0.0;
  const bool is_unexplained = factor > kGoodNoiseFactor;
  return {KeyNumberKind::kReprojectionError,
          fmt::format(
              "{:.3f} px mean, {:.2f} px at most{}", error_px.mean, error_px.max,
              is_unexplained ? fmt::format(", {:.1f} times the noise of the corners", factor) : ""),
          fmt::format("distance between detected and projected corners; good up to a mean of {:g} "
                      "px and {:g} times their noise, above {:g} px the shape may be wrong",
                      kGoodError_px, kGoodNoiseFactor, kBadError_px),
          std::max(LowIsGood(error_px.mean, kGoodError_px, kBadError_px),
                   is_unexplained ? ReportStatus::kCheck : ReportStatus::kGood),
          "check that the calibration belongs to these images, that the layout is that of the "
          "surface, that the surface kept its shape, and that no engine shook the camera"};
}

KeyNumber AreaNumber(const ShapeMetrics& metrics) {
  const Statistics& percent = metrics.area_error_percent;
  return {KeyNumberKind::kMarkerAreaError,
          fmt::format("{:.2f} % mean, {:.2f} % at most", percent.mean, percent.max),
          fmt::format("difference from the printed area; good up to a mean of {:g} %",
                      kGoodAreaError_percent),
          LowIsGood(percent.mean, kGoodAreaError_percent, kBadAreaError_percent),
          "check marker_length by the scale on the printed sheets, and check the calibration"};
}

KeyNumber SizeNumber(const MarkerShape& shape) {
  return {KeyNumberKind::kSize, BoxText(BoundingBox(shape), "\u00d7"),
          "sides of the smallest box around all corners, in any direction", ReportStatus::kNone};
}

std::optional<KeyNumber> PrecisionNumber(const MarkerShape& shape) {
  std::vector<double> sigmas_mm;
  for (const ShapeMarker& marker : shape.markers) {
    if (marker.sigma_m[0]) sigmas_mm.push_back(kMmPerM * marker.sigma_m[0]->norm());
  }
  if (sigmas_mm.empty()) return std::nullopt;
  return KeyNumber{KeyNumberKind::kPrecision,
                   fmt::format("{:.3g} mm median, {:.3g} mm at most", Median(sigmas_mm),
                               *std::max_element(sigmas_mm.begin(), sigmas_mm.end())),
                   "1 sigma of a marker's centre in space, including the scale",
                   ReportStatus::kNone};
}

}  // namespace

std::vector<KeyNumber> MakeKeyNumbers(const ReportInput& input) {
  std::vector<KeyNumber> numbers;
  const auto add = [&numbers](const std::optional<KeyNumber>& number) {
    if (number) numbers.push_back(*number);
  };
  add(MarkersNumber(input.metrics));
  add(ImagesNumber(input));
  if (input.model_metrics.error_px.count > 0) {
    add(ErrorNumber(input.model_metrics.error_px, input.uncertainty));
  }
  if (input.metrics.area_error_percent.count > 0) add(AreaNumber(input.metrics));
  add(DictionaryNumber(input));
  add(CalibrationNumber(input));
  add(SteadinessNumber(input.steadiness));
  add(RollingShutterNumber(input.uncertainty));
  add(FoundCameraNumber(input.found_cameras));
  add(ScaleNumber(input.scale, input.audit, input.uncertainty, input.warnings));
  if (input.audit != nullptr) add(DistancesNumber(*input.audit));
  if (input.known_points != nullptr) add(KnownPointsNumber(*input.known_points));
  add(PrecisionNumber(input.shape));
  add(SizeNumber(input.shape));
  return numbers;
}

std::string KeyNumberName(KeyNumberKind kind) {
  switch (kind) {
    case KeyNumberKind::kDictionary:
      return "Dictionary";
    case KeyNumberKind::kMeasuredDistances:
      return "Measured distances";
    case KeyNumberKind::kKnownPoints:
      return "Known points";
    case KeyNumberKind::kCalibration:
      return "Calibration";
    case KeyNumberKind::kSteadiness:
      return "Camera steadiness";
    case KeyNumberKind::kCamera:
      return "Camera";
    case KeyNumberKind::kRollingShutter:
      return "Rolling shutter";
    case KeyNumberKind::kScale:
      return "Scale";
    case KeyNumberKind::kReprojectionError:
      return "Reprojection error";
    case KeyNumberKind::kMarkerAreaError:
      return "Marker area error";
    case KeyNumberKind::kMarkers:
      return "Markers";
    case KeyNumberKind::kImages:
      return "Images";
    case KeyNumberKind::kPrecision:
      return "Precision";
    case KeyNumberKind::kSize:
      return "Size";
  }
  return {};
}

std::string StatusName(ReportStatus status) {
  switch (status) {
    case ReportStatus::kGood:
      return "good";
    case ReportStatus::kCheck:
      return "check";
    case ReportStatus::kBad:
      return "bad";
    case ReportStatus::kNone:
      return {};
  }
  return {};
}

}  // namespace velamap
