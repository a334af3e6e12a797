#include "exporters/sail/section_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "importer/base/csv.h"

namespace velamap {
namespace {

// Keys of the numbers, the same in CSV and JSON; a sigma has the key with sigma_ before it.
using KeyedEstimates = std::array<std::pair<const char*, std::optional<Estimate>>, 6>;

KeyedEstimates EstimatesOf(const Section& section) {
  return {{{"chord_m", section.chord_m},
           {"camber", section.camber},
           {"draft_position", section.draft_position},
           {"entry_angle_deg", section.entry_angle_deg},
           {"exit_angle_deg", section.exit_angle_deg},
           {"twist_deg", section.twist_deg}}};
}

double ResidualRms(const Section& section) {
  double sum = 0.0;
  for (const SectionMarker& marker : section.markers) sum += marker.residual_m * marker.residual_m;
  return std::sqrt(sum / static_cast<double>(section.markers.size()));
}

void WriteFrameLine(const ShapeFrame& frame, std::ostream& out) {
  out << "# frame " << SingleLine(FrameText(frame)) << '\n';
}

std::string Shortest(double value) { return fmt::format("{}", value); }

}  // namespace

void WriteSectionsCsv(const SectionReport& report, const ShapeFrame& frame, std::ostream& out) {
  WriteFrameLine(frame, out);
  if (!report.twist_reference.empty()) out << "# twist against " << report.twist_reference << '\n';
  for (const std::string& note : report.notes) out << "# " << SingleLine(note) << '\n';
  out << "part,section,height_m,num_markers";
  for (const auto& [key, estimate] : EstimatesOf({})) out << fmt::format(",{},sigma_{}", key, key);
  out << ",residual_rms_mm,reason\n";
  for (const Section& section : report.sections) {
    out << fmt::format("{},{},{},", CsvField(section.part), CsvField(section.name),
                       section.height_m);
    if (section.is_line) out << section.markers.size();
    for (const auto& [key, estimate] : EstimatesOf(section)) {
      const bool has_sigma = estimate && estimate->sigma;
      out << ',' << (estimate ? Shortest(estimate->value) : "") << ','
          << (has_sigma ? Shortest(*estimate->sigma) : "");
    }
    out << ',' << (section.is_line ? Shortest(1e3 * ResidualRms(section)) : "") << ",\n";
  }
  for (const MissingSection& missing : report.missing) {
    out << fmt::format("{},{},,,,,,,,,,,,,,,,{}\n", CsvField(missing.part), CsvField(missing.name),
                       CsvField(missing.reason));
  }
}

void WriteSectionsJson(const SectionReport& report, const ShapeFrame& frame, std::ostream& out) {
  using Json = nlohmann::ordered_json;
  Json root;
  root["frame"] = {
      {"name", frame.name}, {"description", frame.description}, {"reasons", frame.reasons}};
  root["twist_reference"] = report.twist_reference;
  root["notes"] = report.notes;
  root["sections"] = Json::array();
  for (const Section& section : report.sections) {
    Json object = {
        {"part", section.part}, {"section", section.name}, {"height_m", section.height_m}};
    for (const auto& [key, estimate] : EstimatesOf(section)) {
      if (!estimate) continue;
      object[key] = estimate->value;
      if (estimate->sigma) object[fmt::format("sigma_{}", key)] = *estimate->sigma;
    }
    if (section.is_line) {
      object["num_effective_parameters"] = section.num_effective_parameters;
      object["residual_rms_mm"] = 1e3 * ResidualRms(section);
      object["markers"] = Json::array();
      for (const SectionMarker& marker : section.markers) {
        object["markers"].push_back(
            {{"marker_id", marker.marker_id}, {"residual_mm", 1e3 * marker.residual_m}});
      }
    }
    root["sections"].push_back(std::move(object));
  }
  root["missing"] = Json::array();
  for (const MissingSection& missing : report.missing) {
    root["missing"].push_back(
        {{"part", missing.part}, {"section", missing.name}, {"reason", missing.reason}});
  }
  out << root.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
}

void WriteSectionProfilesCsv(const SectionReport& report, const ShapeFrame& frame,
                             std::ostream& out) {
  WriteFrameLine(frame, out);
  out << "part,section,marker_id,x,y,z,chordwise_mm,depth_mm\n";
  for (const Section& section : report.sections) {
    const auto write = [&](const std::string& marker_id, const ProfilePoint& point) {
      const Eigen::Vector3d& x = point.x_in_frame_m;
      out << fmt::format("{},{},{},{},{},{},{},{}\n", CsvField(section.part),
                         CsvField(section.name), marker_id, x.x(), x.y(), x.z(),
                         1e3 * point.chordwise_m, 1e3 * point.depth_m);
    };
    for (const ProfilePoint& point : SampleProfile(section, kNumProfilePoints)) write("", point);
    for (const SectionMarker& marker : section.markers) {
      write(std::to_string(marker.marker_id), ProfilePointOf(section, marker.x_in_frame_m));
    }
  }
}

}  // namespace velamap
