#include "exporters/report/report_sail.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "exporters/sail/sail_metrics.h"
#include "exporters/sail/section_writer.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

using Json = ReportJsonValue;

constexpr double kMaxReportTriangles = 1e4;       // of the surface of a sail
constexpr std::size_t kMaxFreeformDrawn = 20000;  // triangles
constexpr double kMinHorizontal = 0.1;            // below it, a camera looks straight up or down

// The rows of a table, whose keys the page reads.
Json RowsJson(const MetricTable& table) { return MetricsJson({{}, {table}}).at(table.name); }

Json SectionsJson(const std::vector<Section>& sections, const ReportDesign* design) {
  const bool has_parts = sections.front().part != sections.back().part;
  Json rows = RowsJson(SectionTable(sections));
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const Section& section = sections[i];
    Json& row = rows[i];
    row["name"] = has_parts ? section.part + " " + section.name : section.name;
    const std::string missing = MissingEndsText(section);
    if (!missing.empty()) row["note"] = missing;
    row["profile"] = row["profile_in_shape"] = Json::array();
    for (const ProfilePoint& point : SampleProfile(section, kNumProfilePoints)) {
      row["profile"].push_back({point.chordwise_m, point.depth_m});
      row["profile_in_shape"].push_back(VectorJson(point.x_in_frame_m));
    }
    if (design == nullptr || design->profiles_m[i].empty()) continue;
    row["design"] = Json::array();
    for (const Eigen::Vector2d& x : design->profiles_m[i]) row["design"].push_back({x.x(), x.y()});
  }
  return rows;
}

Json SurfaceJson(const std::string& part, bool is_sail, double area_m2, double distance_m) {
  return {{"part", part},
          {"is_sail", is_sail},
          {"area_m2", area_m2},
          {"distance_mm", kMmPerM * distance_m}};
}

// Flat lists in the format of vertex buffers, to 0.01 mm, which halves the file.
void AddMesh(const TriangleMesh& mesh, Json* surface) {
  constexpr double kStepsPerM = 1e5;
  Json vertices = Json::array(), triangles = Json::array();
  for (const Eigen::Vector3d& x : mesh.vertices_m) {
    for (const double value : x) vertices.push_back(std::round(kStepsPerM * value) / kStepsPerM);
  }
  for (const auto& triangle : mesh.triangles) {
    for (const int vertex : triangle) triangles.push_back(vertex);
  }
  (*surface)["vertices"] = std::move(vertices);
  (*surface)["triangles"] = std::move(triangles);
}

Json JsonOf(const SailSurface& surface) {
  Json json = SurfaceJson(surface.part, true, surface.area_m2, surface.fit.distance_m.rms);
  if (surface.rms_sigma_m) json["sigma_mm"] = kMmPerM * *surface.rms_sigma_m;
  MeshOptions options;
  options.edge_length_mm = kMmPerM * std::sqrt(2 * surface.area_m2 / kMaxReportTriangles);
  AddMesh(MeshSurface(surface.fit.surface, options), &json);
  return json;
}

Json JsonOf(const PartSurface& part) {
  const FreeformSurface& surface = part.surface;
  Json json = SurfaceJson(part.part, false, surface.area_m2, surface.distance_m.rms);
  if (surface.volume_m3) json["volume_m3"] = *surface.volume_m3;
  json["sigma_mm"] = kMmPerM * surface.rms_sigma_m;
  const bool is_drawn = surface.mesh.triangles.size() <= kMaxFreeformDrawn;
  AddMesh(is_drawn ? surface.mesh : TriangleMesh(), &json);
  return json;
}

void AddUnlessEmpty(const char* key, Json list, Json* json) {
  if (!list.empty()) (*json)[key] = std::move(list);
}

}  // namespace

std::optional<ReportFrame> MakeReportFrame(const ShapeFrame& frame, const Model& metric_model) {
  if (!frame.up_in_frame) return std::nullopt;
  const Eigen::Vector3d& up = *frame.up_in_frame;
  const Eigen::Quaterniond world_from_cam =
      metric_model.images.front().cam_from_world.rotation.conjugate();
  const Eigen::Vector3d looks = world_from_cam * Eigen::Vector3d::UnitZ();
  Eigen::Vector3d forward = looks - looks.dot(up) * up;
  if (forward.norm() < kMinHorizontal) {
    const Eigen::Vector3d top = world_from_cam * -Eigen::Vector3d::UnitY();
    forward = top - top.dot(up) * up;
  }
  return ReportFrame{frame.name + ": " + frame.description, up, forward.normalized()};
}

void AddSail(const ReportInput& input, Json* json) {
  const SectionReport& sections = input.sail.sections;
  if (!sections.sections.empty()) {
    (*json)["sections"] = SectionsJson(sections.sections, input.design ? &*input.design : nullptr);
  }
  AddUnlessEmpty("section_notes", sections.notes, json);
  Json surface_notes = input.sail.surface_notes, surfaces = Json::array();
  for (const std::string& note : input.freeform.notes) surface_notes.push_back(note);
  AddUnlessEmpty("surface_notes", std::move(surface_notes), json);
  if (input.design) {
    (*json)["design"] = {{"name", input.design->name},
                         {"num_markers", input.design->num_markers},
                         {"distance_mm", input.design->distance_mm}};
  }
  AddUnlessEmpty("rigs", RowsJson(RigTable(sections.rigs)), json);
  for (const SailSurface& surface : input.sail.surfaces) surfaces.push_back(JsonOf(surface));
  for (const PartSurface& part : input.freeform.surfaces) surfaces.push_back(JsonOf(part));
  AddUnlessEmpty("surfaces", std::move(surfaces), json);
}

}  // namespace velamap
