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
#include "exporters/report/verdict.h"
#include "exporters/scale/scale_audit_report.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "reconstruct/registration/registration.h"

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

Json MetricsJson(const MetricsReport& report) {
  std::stringstream text;
  WriteMetricsJson(report, text);
  return Json::parse(text);
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

// Adds NAME_UNIT and, if it is known, NAME_sigma_UNIT.
void AddFigure(const std::string& name, const std::string& unit,
               const std::optional<Estimate>& figure, Json* json) {
  if (!figure) return;
  (*json)[name + '_' + unit] = figure->value;
  if (figure->sigma) (*json)[name + "_sigma_" + unit] = *figure->sigma;
}

Json ProfileJson(const std::vector<Eigen::Vector2d>& profile_m) {
  Json json = Json::array();
  for (const Eigen::Vector2d& x : profile_m) json.push_back({x.x(), x.y()});
  return json;
}

Json JsonOf(const ReportSection& section) {
  Json json = {{"name", section.name}, {"height_m", section.height_m}};
  if (!section.note.empty()) json["note"] = section.note;
  AddFigure("chord", "m", section.chord_m, &json);
  AddFigure("camber", "percent", section.camber_percent, &json);
  AddFigure("draft", "percent", section.draft_percent, &json);
  AddFigure("entry", "deg", section.entry_deg, &json);
  AddFigure("exit", "deg", section.exit_deg, &json);
  AddFigure("twist", "deg", section.twist_deg, &json);
  AddFigure("leech_twist", "deg", section.leech_twist_deg, &json);
  AddFigure("girth", "m", section.girth_m, &json);
  json["profile"] = ProfileJson(section.profile_m);
  if (!section.design_m.empty()) json["design"] = ProfileJson(section.design_m);
  if (!section.profile_in_shape_m.empty()) {
    json["profile_in_shape"] = Json::array();
    for (const Eigen::Vector3d& x : section.profile_in_shape_m) {
      json["profile_in_shape"].push_back(VectorJson(x));
    }
  }
  return json;
}

Json JsonOf(const RigNumbers& rig) {
  Json json = {{"part", rig.part}};
  AddFigure("luff_bend", "m", rig.luff_bend_m, &json);
  AddFigure("luff_sag", "m", rig.luff_sag_m, &json);
  AddFigure("sheeting_angle", "deg", rig.sheeting_angle_deg, &json);
  return json;
}

// Flat lists in the format of vertex buffers, to 0.01 mm, which halves the file.
Json JsonOf(const ReportSurface& surface) {
  constexpr double kStepsPerM = 1e5;
  Json json = {{"part", surface.part},
               {"is_sail", surface.is_sail},
               {"area_m2", surface.area_m2},
               {"distance_mm", surface.distance_mm}};
  if (surface.volume_m3) json["volume_m3"] = *surface.volume_m3;
  if (surface.sigma_mm) json["sigma_mm"] = *surface.sigma_mm;
  Json vertices = Json::array(), triangles = Json::array();
  for (const Eigen::Vector3d& x : surface.x_in_shape_m) {
    for (const double value : x) vertices.push_back(std::round(kStepsPerM * value) / kStepsPerM);
  }
  for (const auto& triangle : surface.triangles) {
    for (const int vertex : triangle) triangles.push_back(vertex);
  }
  json["vertices"] = std::move(vertices);
  json["triangles"] = std::move(triangles);
  return json;
}

template <typename Items>
void AddList(const std::string& name, const Items& items, Json* json) {
  if (items.empty()) return;
  (*json)[name] = Json::array();
  for (const auto& item : items) (*json)[name].push_back(JsonOf(item));
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

LeftOutImages SplitLeftOut(const std::vector<ReportLeftOut>& images) {
  LeftOutImages split;
  const std::string not_chosen = kNotChosen;
  for (const ReportLeftOut& image : images) {
    if (image.reason.rfind(not_chosen, 0) == 0) {
      split.not_needed.push_back({image.name, image.reason.substr(not_chosen.size())});
    } else {
      split.left_out.push_back(image);
    }
  }
  return split;
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
  const LeftOutImages images = SplitLeftOut(input.images_left_out);
  json["images_left_out"] = JsonOf(images.left_out);
  json["images_not_needed"] = JsonOf(images.not_needed);
  json["markers_left_out"] =
      JsonOf(AllMarkersLeftOut(input.markers_left_out, input.shape, input.metrics));
  if (input.audit != nullptr) json["scale_audit"] = AuditJson(*input.audit);
  if (input.known_points != nullptr && !input.known_points->points.empty()) {
    json["known_points"] = JsonOf(*input.known_points);
  }
  json["options"] = PairsJson(input.options);
  json["versions"] = PairsJson(input.versions);
  json["picture"] = PictureJson(input, errors);
  AddList("sections", input.sections, &json);
  if (!input.section_notes.empty()) json["section_notes"] = input.section_notes;
  if (!input.surface_notes.empty()) json["surface_notes"] = input.surface_notes;
  if (input.design) {
    json["design"] = {{"name", input.design->name},
                      {"num_markers", input.design->num_markers},
                      {"distance_mm", input.design->distance_mm}};
  }
  AddList("rigs", input.rigs, &json);
  AddList("surfaces", input.surfaces, &json);
  // File names need not be UTF-8; invalid bytes are replaced.
  return EscapeForScript(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace velamap
