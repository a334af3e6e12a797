#include "exporters/report/report_sail.h"

#include <cmath>

#include <Eigen/Geometry>

#include "exporters/sail/section_writer.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kMaxReportTriangles = 1e4;
constexpr double kMinHorizontal = 0.1;  // below it, a camera looks straight up or down

ReportFigure Figure(double factor, const Estimate& estimate) {
  ReportFigure figure{factor * estimate.value, std::nullopt};
  if (estimate.sigma) figure.sigma = factor * *estimate.sigma;
  return figure;
}

ReportSection MakeSection(const Section& section, bool has_parts) {
  constexpr double kPercent = 100.0;
  ReportSection result;
  result.name = has_parts ? section.part + " " + section.name : section.name;
  result.height_m = section.height_m;
  result.chord_m = Figure(1.0, section.chord_m);
  result.camber_percent = Figure(kPercent, section.camber);
  if (section.draft_position) result.draft_percent = Figure(kPercent, *section.draft_position);
  result.entry_deg = Figure(1.0, section.entry_angle_deg);
  result.exit_deg = Figure(1.0, section.exit_angle_deg);
  result.twist_deg = Figure(1.0, section.twist_deg);
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

std::optional<ReportSurface> MakeReportSurface(const SailShape& sail) {
  if (sail.surfaces.empty()) return std::nullopt;
  ReportSurface result;
  for (const SailSurface& surface : sail.surfaces) {
    MeshOptions options;
    options.edge_length_mm = kMmPerM * std::sqrt(2 * surface.area_m2 / kMaxReportTriangles);
    const TriangleMesh mesh = MeshSurface(surface.fit.surface, options);
    const int first = static_cast<int>(result.x_in_shape_m.size());
    result.x_in_shape_m.insert(result.x_in_shape_m.end(), mesh.vertices_m.begin(),
                               mesh.vertices_m.end());
    for (const auto& [a, b, c] : mesh.triangles) {
      result.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return result;
}

}  // namespace velamap
