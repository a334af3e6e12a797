#include "exporters/report/report_data.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "exporters/datum/known_points_report.h"
#include "exporters/report/html_page.h"
#include "exporters/report/report_histogram.h"
#include "exporters/report/report_json.h"
#include "exporters/report/report_key_numbers.h"
#include "exporters/report/report_sail.h"
#include "exporters/report/verdict.h"
#include "exporters/scale/scale_audit_report.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "importer/text/json_text.h"

namespace velamap {
namespace {

using Json = ReportJsonValue;

Json JsonOf(const ReportFrame& frame) {
  return {
      {"name", frame.name}, {"up", VectorJson(frame.up)}, {"forward", VectorJson(frame.forward)}};
}

ReportFrame FrameOfCentralCamera(const Model& model) {
  const Eigen::Quaterniond world_from_cam =
      model.images.front().cam_from_world.rotation.conjugate();
  return {"axes of the model; up and front as for the central camera",
          world_from_cam * -Eigen::Vector3d::UnitY(), world_from_cam * Eigen::Vector3d::UnitZ()};
}

Json KeyNumbersJson(const ReportInput& input) {
  Json numbers = Json::array();
  for (const KeyNumber& number : MakeKeyNumbers(input)) {
    numbers.push_back({{"name", KeyNumberName(number.kind)},
                       {"value", number.value},
                       {"meaning", number.meaning},
                       {"status", StatusName(number.status)}});
  }
  return numbers;
}

Json JsonOf(const Histogram& histogram) {
  return {{"first_border", histogram.first_border},
          {"bin_width", histogram.bin_width},
          {"counts", histogram.counts},
          {"num_below", histogram.num_below},
          {"num_above", histogram.num_above}};
}

Json HistogramsJson(const ReportInput& input, const std::vector<ObservationError>& errors) {
  std::vector<double> deviations_percent, errors_px;
  for (const ShapeMarker& marker : input.shape.markers) {
    if (!marker.IsWhole()) continue;
    deviations_percent.push_back(AreaDeviationPercent(marker, input.layout));
  }
  for (const ObservationError& error : errors) errors_px.push_back(error.error_px);
  return {{"area_deviation_percent", JsonOf(MakeHistogram(std::move(deviations_percent)))},
          {"error_px", JsonOf(MakeHistogram(std::move(errors_px)))}};
}

Json ScaleJson(const ScaleEstimate& scale) {
  Json json = {{"m_per_unit", scale.m_per_unit},
               {"spread_percent", 100 * scale.relative_spread},
               {"num_markers", scale.num_markers}};
  if (scale.relative_sigma) json["sigma_percent"] = 100 * *scale.relative_sigma;
  return json;
}

// An object as a list of pairs of key and value.
Json PairsOf(const Json& object) {
  Json pairs = Json::array();
  for (const auto& [key, value] : object.items()) pairs.push_back(Json::array({key, value}));
  return pairs;
}

// The figures of the audit as pairs of key and value, then the rows of its tables as pairs of the
// table's name and a list of such pairs. Without the histogram, which the page draws itself, and
// the table of all markers, which is long.
Json AuditJson(const ScaleAudit& audit) {
  MetricsReport figures;
  AddMetrics(audit, &figures);
  const MetricsReport tables{{}, std::exchange(figures.tables, {})};
  Json lines = PairsOf(MetricsJson(figures));
  const Json rows_of = MetricsJson(tables);
  for (const MetricTable& table : tables.tables) {
    if (!table.in_text || table.name == "scale_histogram") continue;
    for (const Json& row : rows_of.at(table.name)) {
      lines.push_back(Json::array({table.name, PairsOf(row)}));
    }
  }
  return lines;
}

// The rows of the table of the metrics.
Json JsonOf(const KnownPointFit& fit) {
  MetricsReport report;
  AddMetrics(fit, &report);
  return MetricsJson(report).at("known_points");
}

Json PairsJson(const std::vector<std::pair<std::string, std::string>>& pairs) {
  Json json = Json::array();
  for (const auto& [name, value] : pairs) json.push_back({name, value});
  return json;
}

Json JsonOf(const std::vector<ReportLeftOut>& left_out) {
  Json json = Json::array();
  for (const ReportLeftOut& entry : left_out) {
    json.push_back({{"name", entry.name}, {"reason", entry.reason}});
  }
  return json;
}

// Camera, frame rate and duration in words.
Json OriginJson(const ReportInput& input) {
  const Camera& camera = input.metric_model.cameras.at(input.metric_model.images.front().camera_id);
  Json origin = {fmt::format("camera {} x {} px, {}, focal length {:.0f} px", camera.width_px,
                             camera.height_px, CameraModelName(camera.model),
                             MeanFocalLength(camera))};
  if (input.clip) {
    origin.push_back(fmt::format("{:.4g} frames/s", input.clip->frames_per_s));
    origin.push_back(fmt::format("{:.1f} s", input.clip->duration_s));
  }
  return origin;
}

}  // namespace

Json MetricsJson(const MetricsReport& report) {
  std::stringstream text;
  WriteMetricsJson(report, text);
  return Json::parse(text);
}

std::vector<ReportLeftOut> AllMarkersLeftOut(std::vector<ReportLeftOut> known,
                                             const MarkerShape& shape,
                                             const ShapeMetrics& metrics) {
  std::vector<ReportLeftOut> left_out = std::move(known);
  std::set<std::string> names;
  for (const ReportLeftOut& entry : left_out) names.insert(entry.name);
  std::map<int, int> num_corners_of;
  for (const ShapeMarker& marker : shape.markers) {
    num_corners_of[marker.marker_id] =
        static_cast<int>(std::count_if(marker.x_in_shape_m.begin() + 1, marker.x_in_shape_m.end(),
                                       [](const auto& x) { return x.has_value(); }));
  }
  for (const int marker_id : metrics.missing_marker_ids) {
    const std::string name = std::to_string(marker_id);
    if (names.count(name) > 0) continue;
    const int num_corners = num_corners_of[marker_id];
    left_out.push_back({name, num_corners == 0
                                  ? "no corner reconstructed: not seen in two of the images used"
                                  : fmt::format("{} of its 4 corners reconstructed", num_corners)});
  }
  return left_out;
}

std::string BoxText(const Eigen::Vector3d& sides_m, const std::string& times) {
  const bool is_small = sides_m.maxCoeff() < 1;
  const Eigen::Vector3d shown = is_small ? kMmPerM * sides_m : sides_m;
  const int num_digits = is_small ? 2 : 3;
  return fmt::format("{:.{}f} {} {:.{}f} {} {:.{}f} {}", shown.x(), num_digits, times, shown.y(),
                     num_digits, times, shown.z(), num_digits, is_small ? "mm" : "m");
}

std::string ReportJson(const ReportInput& input) {
  if (input.metric_model.images.empty()) {
    throw DataError("the model has no images, so there is nothing to report");
  }
  const std::vector<ObservationError> errors = ComputeReprojectionErrors(input.metric_model);
  Json json = {{"title", input.title}, {"version", input.version}};
  if (!input.created.empty()) json["created"] = input.created;
  json["origin"] = OriginJson(input);
  json["frame"] = JsonOf(input.frame.value_or(FrameOfCentralCamera(input.metric_model)));
  json["verdict"] = VerdictJson(MakeVerdict(input));
  json["key_numbers"] = KeyNumbersJson(input);
  json["markers"] = MarkersJson(input, errors);
  json["images"] = ImagesJson(input);
  json["histograms"] = HistogramsJson(input, errors);
  json["scale"] = ScaleJson(input.scale);
  json["images_left_out"] = JsonOf(input.images_left_out);
  json["images_not_needed"] = JsonOf(input.images_not_needed);
  json["markers_left_out"] =
      JsonOf(AllMarkersLeftOut(input.markers_left_out, input.shape, input.metrics));
  if (input.audit != nullptr) json["scale_audit"] = AuditJson(*input.audit);
  if (input.known_points != nullptr && !input.known_points->points.empty()) {
    json["known_points"] = JsonOf(*input.known_points);
  }
  json["options"] = PairsJson(input.options);
  json["versions"] = PairsJson(input.versions);
  json["picture"] = PictureJson(input, errors);
  AddSail(input, &json);
  return EscapeForScript(JsonText(json));
}

}  // namespace velamap
