#include "workflows/run/run_summary.h"

#include <map>
#include <ostream>
#include <set>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "exporters/datum/known_points_report.h"
#include "exporters/sail/sail_metrics.h"
#include "exporters/scale/scale_audit_report.h"
#include "exporters/shape/shape_sigma.h"
#include "exporters/shape_report.h"
#include "importer/geometry/units.h"
#include "importer/text/number_text.h"
#include "workflows/run/summary.h"

namespace velamap {
namespace {

std::string ColmapCommand(const WorkspacePaths& paths) {
  return fmt::format("colmap gui --database_path {} --image_path {} --import_path {}",
                     ShellQuote(paths.Database().string()), ShellQuote(paths.Images().string()),
                     ShellQuote(paths.Model().string()));
}

// Those that the registration dropped, and those that are not whole: as the report counts them.
std::vector<ReportLeftOut> MarkersLeftOut(const ReconstructionSummary& summary) {
  return AllMarkersLeftOut(NamedById(summary.dropped_markers), summary.shape.shape,
                           summary.shape.metrics);
}

void PrintMarkers(const ReconstructionSummary& summary, std::ostream& out) {
  const ShapeMetrics& metrics = summary.shape.metrics;
  out << fmt::format("markers: {}", metrics.NumWholeOfLayout());
  if (metrics.num_layout_markers) out << fmt::format(" of {}", *metrics.num_layout_markers);
  if (summary.shape.uncertainty) {
    const std::map<int, double> sigmas_mm = CenterSigmas_mm(summary.shape.uncertainty->points);
    if (!sigmas_mm.empty()) {
      out << fmt::format(", known to {:.2g} mm (1 sigma, median)", MedianSigma(sigmas_mm));
    }
  }
  out << '\n';
  const std::vector<ReportLeftOut> left_out = MarkersLeftOut(summary);
  if (!left_out.empty())
    out << fmt::format("markers left out: {}\n", LeftOutText(left_out, "marker"));
}

void PrintSize(const ShapeExportReport& shape, std::ostream& out) {
  out << fmt::format("size: {}", BoxText(BoundingBox(shape.shape), "x"));
  if (shape.scale.relative_sigma) {
    out << fmt::format(", known to {:.2f} % (1 sigma", 100.0 * *shape.scale.relative_sigma);
    if (shape.scale.print_sigma > 0) {
      out << fmt::format(", of which {:.2f} % is assumed for the print",
                         100.0 * shape.scale.print_sigma);
    }
    out << ')';
  }
  out << fmt::format(
      "; the sides of the markers{} differ from their printed length by {:.2g} mm on average\n",
      shape.audit.markers_bend ? ", which bend," : "", shape.metrics.side_error_mm.mean);
}

std::string RollingShutterText(const AdjustmentResult& adjustment) {
  if (!adjustment.uncertainty || !(adjustment.uncertainty->rolling_shutter_sigma_s > 0)) return "";
  return fmt::format("; rolling shutter of {:.2f} +- {:.2f} ms corrected",
                     1e3 * adjustment.uncertainty->rolling_shutter_s,
                     1e3 * adjustment.uncertainty->rolling_shutter_sigma_s);
}

void PrintImages(const ReconstructionSummary& summary, std::ostream& out) {
  out << fmt::format("images: {} of {} used, {:.2g} px mean reprojection error{}\n",
                     summary.num_images, summary.num_images_total,
                     summary.shape.model_metrics.error_px.mean,
                     RollingShutterText(summary.adjustment));
  if (!summary.images_left_out.empty()) {
    out << fmt::format("images left out: {}\n", LeftOutText(summary.images_left_out));
  }
}

std::string SectionText(const Section& section) {
  std::string text =
      fmt::format("{} at {} m: camber {} %", section.name, FixedText(section.height_m, 2),
                  FixedText(100.0 * section.camber.value, 1));
  if (section.draft_position) {
    text += fmt::format(" with the draft at {:.0f} %", 100.0 * section.draft_position->value);
  }
  if (section.twist_deg) {
    text += fmt::format(", twist {} deg", FixedText(section.twist_deg->value, 1));
  }
  const std::string missing = MissingEndsText(section);
  return missing.empty() ? text : text + ", only a part of the chord: " + missing;
}

// The lowest, the middle and the highest section of a part with lines, which are listed in turn.
void PrintSectionsOf(const std::vector<const Section*>& sections, std::ostream& out) {
  const std::size_t last = sections.size() - 1;
  const std::set<std::size_t> shown = {0, sections.size() / 2, last};
  std::vector<std::string> texts;
  for (const std::size_t i : shown) texts.push_back(SectionText(*sections[i]));
  out << fmt::format("sections of {}{}: {}\n", sections.front()->part,
                     shown.size() < sections.size()
                         ? fmt::format(" ({} of {})", shown.size(), sections.size())
                         : "",
                     fmt::join(texts, "; "));
}

void PrintSections(const SectionReport& report, std::ostream& out) {
  std::vector<const Section*> of_part;
  for (const Section& section : report.sections) {
    if (!of_part.empty() && of_part.back()->part != section.part) {
      PrintSectionsOf(of_part, out);
      of_part.clear();
    }
    of_part.push_back(&section);
  }
  if (!of_part.empty()) PrintSectionsOf(of_part, out);
  PrintRigs(report.rigs, out);
  std::vector<ReportLeftOut> missing;
  for (const MissingSection& one : report.missing) {
    missing.push_back({one.part + " " + one.name, one.reason});
  }
  if (!missing.empty()) out << fmt::format("sections missing: {}\n", LeftOutText(missing));
  if (!report.notes.empty()) out << fmt::format("sections: {}\n", fmt::join(report.notes, "; "));
}

// All surfaces in one line. Notes about them are in the report and in the log.
void PrintSurfaces(const ShapeExportReport& shape, std::ostream& out) {
  std::vector<std::string> texts;
  for (const SailSurface& surface : shape.sail.surfaces) {
    texts.push_back(fmt::format("{} {:.4g} m2, {:.2g} mm RMS from its markers", surface.part,
                                surface.area_m2, kMmPerM * surface.fit.distance_m.rms));
  }
  for (const PartSurface& part : shape.freeform.surfaces) {
    texts.push_back(fmt::format("{} {}, known to {:.2g} mm (1 sigma)", ShownName(part.part),
                                SizeText(part.surface), kMmPerM * part.surface.rms_sigma_m));
  }
  const std::size_t num_notes = SurfaceNotes(shape).size();
  if (num_notes > 0) {
    texts.push_back(fmt::format("{} note{} in the report", num_notes, num_notes == 1 ? "" : "s"));
  }
  if (!texts.empty()) out << fmt::format("surfaces: {}\n", fmt::join(texts, "; "));
}

void PrintCamera(const ReconstructionSummary& summary, const WorkspacePaths& paths,
                 std::ostream& out) {
  for (const auto& [camera_id, camera] : summary.adjustment.cameras) {
    out << fmt::format("camera: found from the images, {}\n",
                       FoundCameraText(camera, summary.verdict, paths.Camera().string()));
  }
}

// One row for each name, with why it was left out.
template <typename Items, typename Name>
MetricTable LeftOutTable(const std::string& table, const std::string& key, const Items& items,
                         const Name& name) {
  MetricTable result{table, true, {}};
  for (const auto& item : items)
    result.rows.push_back({{key, name(item)}, {"reason", item.reason}});
  return result;
}

}  // namespace

std::string FoundCameraText(const EstimatedCamera& camera, const Verdict& verdict,
                            const std::string& path) {
  const std::string reason = WhyNotForOtherClips(camera);
  const bool is_good = verdict.level != ReportStatus::kBad && reason.empty();
  return fmt::format("{}; {} {}{}{}", DescribeCamera(camera), path,
                     is_good ? "serves the next clip" : "is not good enough for other clips",
                     reason.empty() ? "" : ": ", reason);
}

void PrintSummary(const ReconstructionSummary& summary, const WorkspacePaths& paths,
                  std::ostream& out) {
  PrintVerdict(summary.verdict, out);
  PrintMarkers(summary, out);
  PrintSize(summary.shape, out);
  if (!summary.shape.known_points.points.empty()) {
    out << fmt::format("known points: {}\n", KnownPointsText(summary.shape.known_points));
  }
  PrintImages(summary, out);
  PrintSections(summary.shape.sail.sections, out);
  PrintSurfaces(summary.shape, out);
  PrintCamera(summary, paths, out);
  out << fmt::format("look at: {} (in a browser); CSV, PLY and CAD files in {}\n",
                     paths.Report().string(), paths.Shape().string());
  out << fmt::format("in COLMAP: {}\n", ColmapCommand(paths));
}

MetricsReport SummaryMetrics(const ReconstructionSummary& summary, const WorkspacePaths& paths) {
  MetricsReport report;
  const ShapeExportReport& shape = summary.shape;
  const Eigen::Vector3d box_m = BoundingBox(shape.shape);
  report.metrics = {{"verdict", StatusName(summary.verdict.level)},
                    {"num_images_used", summary.num_images},
                    {"num_images", summary.num_images_total},
                    {"num_outliers_removed", summary.adjustment.num_removed},
                    {"length_m", box_m.x()},
                    {"width_m", box_m.y()},
                    {"depth_m", box_m.z()},
                    {"workspace_path", paths.root.string()},
                    {"colmap_command", ColmapCommand(paths)}};
  MetricTable reasons{"verdict_reasons", true, {}};
  for (const VerdictReason& reason : summary.verdict.reasons) {
    reasons.rows.push_back({{"level", StatusName(reason.level)}, {"reason", reason.text}});
  }
  MetricTable cameras{"cameras_found", true, {}};
  for (const auto& [camera_id, camera] : summary.adjustment.cameras) {
    cameras.rows.push_back({{"camera_id", static_cast<int>(camera_id)},
                            {"camera", DescribeCamera(camera)},
                            {"not_for_other_clips", WhyNotForOtherClips(camera)}});
  }
  const auto name_of_image = [](const ReportLeftOut& image) { return image.name; };
  report.tables = {
      reasons,
      LeftOutTable("images_left_out", "image_name", summary.images_left_out, name_of_image),
      LeftOutTable("images_not_needed", "image_name", summary.images_not_needed, name_of_image),
      LeftOutTable("markers_left_out", "marker_id", MarkersLeftOut(summary),
                   [](const ReportLeftOut& marker) { return std::stoi(marker.name); }),
      SectionTable(shape.sail.sections.sections),
      LeftOutTable("sections_missing", "section", shape.sail.sections.missing,
                   [](const MissingSection& missing) { return missing.part + " " + missing.name; }),
      cameras};
  AddMetrics(shape.metrics, &report);
  AddMetrics(shape.model_metrics, &report);
  AddMetrics(shape.scale, &report);
  AddMetrics(shape.audit, &report);
  AddMetrics(shape.frame, &report);
  AddMetrics(shape.known_points, &report);
  AddMetrics(shape.sail, &report);
  AddMetrics(shape.freeform, &report);
  if (summary.adjustment.uncertainty) AddMetrics(*summary.adjustment.uncertainty, &report);
  return report;
}

}  // namespace velamap
