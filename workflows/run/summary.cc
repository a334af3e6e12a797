#include "workflows/run/summary.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <optional>
#include <ostream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "exporters/datum/known_points_report.h"
#include "exporters/scale/scale_audit_report.h"
#include "importer/base/log.h"
#include "importer/geometry/units.h"
#include "importer/text/id_ranges.h"
#include "importer/text/number_text.h"
#include "workflows/run/logging.h"

namespace velamap {
namespace {

constexpr std::size_t kMaxNames = 3;

struct ReasonGroup {
  std::string key;     // the reason without its numbers
  std::string reason;  // of the first of them
  std::vector<std::string> names;
};

std::string WithoutNumbers(const std::string& text) {
  std::string rest;
  for (const char c : text) {
    if (!std::isdigit(static_cast<unsigned char>(c))) rest += c;
  }
  return rest;
}

std::vector<ReasonGroup> GroupByReason(const std::vector<ReportLeftOut>& left_out) {
  std::vector<ReasonGroup> groups;
  for (const ReportLeftOut& one : left_out) {
    const std::string key = WithoutNumbers(one.reason);
    auto it = std::find_if(groups.begin(), groups.end(),
                           [&](const ReasonGroup& group) { return group.key == key; });
    if (it == groups.end()) it = groups.insert(it, {key, one.reason, {}});
    it->names.push_back(one.name);
  }
  return groups;
}

std::string FirstNames(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxNames); ++i) {
    text += (i > 0 ? ", " : "") + names[i];
  }
  return names.size() > kMaxNames ? text + ", ..." : text;
}

// `3.1 to 9.5`; empty if no section has such a number.
std::string RangeText(const std::vector<Section>& sections,
                      std::optional<double> (*value)(const Section&)) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Section& section : sections) {
    const std::optional<double> of_section = value(section);
    if (!of_section) continue;
    low = std::min(low, *of_section);
    high = std::max(high, *of_section);
  }
  return low > high ? "" : FixedText(low, 1) + " to " + FixedText(high, 1);
}

std::string LuffText(const Estimate& estimate_m, const char* positive, const char* negative) {
  const auto& [value_m, sigma_m] = estimate_m;
  return fmt::format("{} mm {}", UncertainText(std::abs(value_m), sigma_m, kMmPerM, 1, "+-"),
                     value_m < 0 ? negative : positive);
}

// Empty if no number is known.
std::string RigText(const RigNumbers& rig) {
  std::string text;
  if (rig.luff_bend_m && rig.luff_sag_m) {
    text = fmt::format("luff bent {} and {}", LuffText(*rig.luff_bend_m, "forwards", "aft"),
                       LuffText(*rig.luff_sag_m, "to leeward", "to windward"));
  }
  if (rig.sheeting_angle_deg) {
    const auto& [value_deg, sigma_deg] = *rig.sheeting_angle_deg;
    text += fmt::format("{}sheeting angle {} deg", text.empty() ? "" : ", ",
                        UncertainText(value_deg, sigma_deg, 1, 1, "+-"));
  }
  return text.empty() ? text : rig.part + ", " + text;
}

// Prints the frame, the sections of a sail, and the surfaces.
void PrintSail(const ShapeExportReport& report, std::ostream& out) {
  out << fmt::format("frame: {}\n", report.frame.name);
  const std::vector<Section>& sections = report.sail.sections.sections;
  if (!sections.empty()) {
    const auto camber_percent = [](const Section& s) -> std::optional<double> {
      return 100.0 * s.camber.value;
    };
    const auto twist_deg = [](const Section& s) -> std::optional<double> {
      if (!s.twist_deg) return std::nullopt;
      return s.twist_deg->value;
    };
    const std::string twists = RangeText(sections, twist_deg);
    out << fmt::format("sections: {}; camber {} %, {}\n", sections.size(),
                       RangeText(sections, camber_percent),
                       twists.empty() ? "no twist" : fmt::format("twist {} deg", twists));
  }
  PrintRigs(report.sail.sections.rigs, out);
  for (const std::string& note : report.sail.sections.notes) {
    out << fmt::format("section_note: {}\n", note);
  }
  for (const MissingSection& missing : report.sail.sections.missing) {
    out << fmt::format("section_missing: {} {}: {}\n", missing.part, missing.name, missing.reason);
  }
  for (const SailSurface& surface : report.sail.surfaces) {
    out << fmt::format("surface: {}; {:.4g} m2, markers {:.2f} mm RMS from it\n", surface.part,
                       surface.area_m2, kMmPerM * surface.fit.distance_m.rms);
  }
  for (const PartSurface& part : report.freeform.surfaces) {
    out << fmt::format("surface: {}; {}, corners {:.2g} mm RMS from it, sigma {:.2g} mm\n",
                       ShownName(part.part), SizeText(part.surface),
                       kMmPerM * part.surface.distance_m.rms, kMmPerM * part.surface.rms_sigma_m);
  }
  for (const std::string& note : SurfaceNotes(report)) {
    out << fmt::format("surface_note: {}\n", note);
  }
}

}  // namespace

std::string LeftOutText(const std::vector<ReportLeftOut>& left_out, const std::string& kind) {
  const std::vector<ReasonGroup> groups = GroupByReason(left_out);
  if (groups.empty()) return "none";
  std::string text = groups.size() > 1 ? std::to_string(left_out.size()) : "";
  for (const ReasonGroup& group : groups) {
    const std::string of_kind = kind.empty() ? "" : kind + (group.names.size() > 1 ? "s " : " ");
    text += fmt::format("{}{}: {} ({}{})", text.empty() ? "" : "; ", group.names.size(),
                        group.reason, of_kind, FirstNames(group.names));
  }
  return text;
}

std::vector<ReportLeftOut> NamedById(const std::vector<DroppedMarker>& markers) {
  std::vector<ReportLeftOut> named;
  for (const DroppedMarker& marker : markers) {
    named.push_back({std::to_string(marker.marker_id), marker.reason});
  }
  return named;
}

std::string ErrorText(const Statistics& statistics) {
  return fmt::format("mean {:.3f}, std {:.3f}, median {:.3f}, min {:.3f}, max {:.3f}",
                     statistics.mean, statistics.standard_deviation, statistics.median,
                     statistics.min, statistics.max);
}

void PrintRigs(const std::vector<RigNumbers>& rigs, std::ostream& out) {
  for (const RigNumbers& rig : rigs) {
    const std::string text = RigText(rig);
    if (!text.empty()) out << fmt::format("rig: {}\n", text);
  }
}

std::string ShellQuote(const std::string& text) {
  const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) ||
           std::string("/._-+,:@%").find(static_cast<char>(c)) != std::string::npos;
  });
  if (plain) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::vector<std::string> WarningsBeforeContradictions(const ShapeExportReport& report) {
  std::vector<std::string> so_far = LoggedWarnings();
  for (const std::string& warning : ScaleWarnings(report.audit)) LogWarning(warning);
  for (const std::string& warning : KnownPointWarnings(report.known_points)) LogWarning(warning);
  return so_far;
}

void WarnOfOtherMarkers(const ShapeMetrics& metrics) {
  if (metrics.other_marker_ids.empty()) return;
  LogWarning(
      "{} markers of the shape are not in the layout and are taken to have its marker_length: {}; "
      "is it the layout of this surface?",
      metrics.other_marker_ids.size(), IdRanges(metrics.other_marker_ids));
}

void WarnOfMissingSections(const SectionReport& sections) {
  for (const MissingSection& missing : sections.missing) {
    // Limits of the layout are reported, but are no reason to check this clip.
    LogMessage(missing.is_by_layout ? LogLevel::kInfo : LogLevel::kWarn, "no section {} of {}: {}",
               missing.name, missing.part, missing.reason);
  }
  std::vector<std::string> of_a_part;
  for (const Section& section : sections.sections) {
    const std::string missing = MissingEndsText(section);
    if (!missing.empty()) {
      of_a_part.push_back(fmt::format("{} of {} ({})", section.name, section.part, missing));
    }
  }
  if (of_a_part.empty()) return;
  LogWarning(
      "these sections cover only a part of the chord, so their camber and twist are not those of "
      "the whole: {}",
      fmt::join(of_a_part, ", "));
}

std::vector<std::string> SurfaceNotes(const ShapeExportReport& report) {
  std::vector<std::string> notes = report.sail.surface_notes;
  notes.insert(notes.end(), report.freeform.notes.begin(), report.freeform.notes.end());
  return notes;
}

void PrintShapeSummary(const ShapeExportReport& report, std::ostream& out) {
  const ShapeMetrics& metrics = report.metrics;
  const Eigen::Vector3d box_m = BoundingBox(report.shape);
  out << "markers_reconstructed: " << metrics.NumWholeOfLayout();
  if (metrics.num_layout_markers) out << " of " << *metrics.num_layout_markers << " in the layout";
  if (!metrics.other_marker_ids.empty()) {
    out << ", and " << metrics.other_marker_ids.size() << " others";
  }
  out << '\n';
  if (metrics.reconstruction_ratio) {
    out << fmt::format("reconstruction_ratio: {:.4g}\n", *metrics.reconstruction_ratio);
  }
  if (metrics.sail_reconstruction_ratio) {
    const double ratio = *metrics.sail_reconstruction_ratio;
    const int num_markers = *metrics.num_sail_markers;
    out << fmt::format("sail_reconstruction_ratio: {:.4g} ({:.0f} of {} markers)\n", ratio,
                       ratio * num_markers, num_markers);
  }
  const ModelMetrics& model = report.model_metrics;
  out << fmt::format("reprojection_error_px: {}\n", ErrorText(model.error_px));
  out << fmt::format("central_image_name: {}\n", model.central_image_name);
  out << fmt::format("central_reprojection_error_px: {}\n", ErrorText(model.central_error_px));
  out << fmt::format("area_error_mm2: {}\n", ErrorText(metrics.area_error_mm2));
  out << fmt::format("area_error_percent: {}\n", ErrorText(metrics.area_error_percent));
  out << fmt::format("side_error_mm: {}\n", ErrorText(metrics.side_error_mm));
  out << fmt::format("scale_m_per_unit: {:.6g}\n", report.scale.m_per_unit);
  out << fmt::format("scale_spread_over_markers: {:.3f} %\n", 100.0 * report.scale.relative_spread);
  PrintScaleAudit(report.scale, report.audit, out);
  if (!report.known_points.points.empty()) {
    out << fmt::format("known_points: {}\n", KnownPointsText(report.known_points));
  }
  PrintSail(report, out);
  out << fmt::format("bounding_box_m: {:.4f} x {:.4f} x {:.4f}\n", box_m.x(), box_m.y(), box_m.z());
}

void PrintRollingShutter(const AdjustmentUncertainty& uncertainty, std::ostream& out) {
  if (!(uncertainty.rolling_shutter_sigma_s > 0)) return;
  out << fmt::format("rolling_shutter_ms: {:.2f} +- {:.2f}\n", 1e3 * uncertainty.rolling_shutter_s,
                     1e3 * uncertainty.rolling_shutter_sigma_s);
}

}  // namespace velamap
