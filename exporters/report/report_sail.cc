#include "exporters/report/report_sail.h"

#include <cmath>

#include <Eigen/Geometry>

#include "exporters/sail/section_writer.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kMaxReportTriangles = 1e4;       // of the surface of a sail
constexpr std::size_t kMaxFreeformDrawn = 20000;  // triangles
constexpr double kMinHorizontal = 0.1;            // below it, a camera looks straight up or down

Estimate InPercent(const Estimate& share) {
  Estimate percent{100 * share.value, std::nullopt};
  if (share.sigma) percent.sigma = 100 * *share.sigma;
  return percent;
}

ReportSection MakeSection(const Section& section, bool has_parts) {
  ReportSection result;
  result.name = has_parts ? section.part + " " + section.name : section.name;
  result.note = MissingEndsText(section);
  result.height_m = section.height_m;
  result.chord_m = section.chord_m;
  result.camber_percent = InPercent(section.camber);
  if (section.draft_position) result.draft_percent = InPercent(*section.draft_position);
  result.entry_deg = section.entry_angle_deg;
  result.exit_deg = section.exit_angle_deg;
  result.twist_deg = section.twist_deg;
  result.leech_twist_deg = section.leech_twist_deg;
  result.girth_m = section.girth_m;
  for (const ProfilePoint& point : SampleProfile(section, kNumProfilePoints)) {
    result.profile_m.emplace_back(point.chordwise_m, point.depth_m);
    result.profile_in_shape_m.push_back(point.x_in_frame_m);
  }
  return result;
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

std::vector<ReportSection> MakeReportSections(const SectionReport& sections) {
  std::vector<ReportSection> result;
  for (const Section& section : sections.sections) {
    const bool has_parts = section.part != sections.sections.front().part ||
                           section.part != sections.sections.back().part;
    result.push_back(MakeSection(section, has_parts));
  }
  return result;
}

std::vector<RigNumbers> MakeReportRigs(const SectionReport& sections) {
  std::vector<RigNumbers> result;
  for (const RigNumbers& rig : sections.rigs) {
    if (rig.luff_bend_m || rig.sheeting_angle_deg) result.push_back(rig);
  }
  return result;
}

std::vector<ReportSurface> MakeReportSurfaces(const SailShape& sail,
                                              const FreeformShape& freeform) {
  std::vector<ReportSurface> result;
  for (const SailSurface& surface : sail.surfaces) {
    MeshOptions options;
    options.edge_length_mm = kMmPerM * std::sqrt(2 * surface.area_m2 / kMaxReportTriangles);
    TriangleMesh mesh = MeshSurface(surface.fit.surface, options);
    result.push_back({surface.part, true, surface.area_m2, std::nullopt,
                      kMmPerM * surface.fit.distance_m.rms, std::nullopt,
                      std::move(mesh.vertices_m), std::move(mesh.triangles)});
    if (surface.rms_sigma_m) result.back().sigma_mm = kMmPerM * *surface.rms_sigma_m;
  }
  for (const PartSurface& part : freeform.surfaces) {
    const FreeformSurface& surface = part.surface;
    result.push_back({part.part,
                      false,
                      surface.area_m2,
                      surface.volume_m3,
                      kMmPerM * surface.distance_m.rms,
                      kMmPerM * surface.rms_sigma_m,
                      {},
                      {}});
    if (surface.mesh.triangles.size() > kMaxFreeformDrawn) continue;
    result.back().x_in_shape_m = surface.mesh.vertices_m;
    result.back().triangles = surface.mesh.triangles;
  }
  return result;
}

}  // namespace velamap
