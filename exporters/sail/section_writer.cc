#include "exporters/sail/section_writer.h"

#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "exporters/sail/sail_metrics.h"
#include "importer/base/statistics.h"
#include "importer/geometry/units.h"
#include "importer/text/csv.h"
#include "importer/text/json_text.h"

namespace velamap {
namespace {

using Json = nlohmann::ordered_json;

double ResidualRmsMm(const Section& section) {
  std::vector<double> residuals_m;
  for (const SectionMarker& marker : section.markers) residuals_m.push_back(marker.residual_m);
  return kMmPerM * Rms(residuals_m);
}

// Files of sections have the key of a sigma in front of that of its number, as in shape.csv.
void AddKeys(const std::string& key, const std::optional<Estimate>& estimate, Json* object) {
  if (!estimate) return;
  (*object)[key] = estimate->value;
  if (estimate->sigma) (*object)["sigma_" + key] = *estimate->sigma;
}

Json RigJson(const RigNumbers& rig) {
  Json object = {{"part", rig.part},
                 {"twist_reference", rig.twist_reference},
                 {"up_reference", rig.up_reference},
                 {"aft_reference", rig.aft_reference}};
  if (!rig.reference_section.empty()) object["reference_section"] = rig.reference_section;
  AddKeys("luff_bend_m", rig.luff_bend_m, &object);
  AddKeys("luff_sag_m", rig.luff_sag_m, &object);
  AddKeys("sheeting_angle_deg", rig.sheeting_angle_deg, &object);
  object["luff_markers"] = rig.luff_marker_ids;
  return object;
}

void WriteSectionRecord(const Section& section, CsvWriter* csv) {
  csv->AddField(section.part);
  csv->AddField(section.name);
  csv->AddField(section.height_m);
  csv->AddField(section.is_line ? std::optional(section.markers.size()) : std::nullopt);
  for (const SectionColumn& column : SectionColumns(section)) {
    const std::optional<Estimate>& estimate = column.estimate;
    csv->AddField(estimate ? std::optional(estimate->value) : std::nullopt);
    csv->AddField(estimate ? estimate->sigma : std::nullopt);
  }
  csv->AddField(section.is_line ? std::optional(ResidualRmsMm(section)) : std::nullopt);
  csv->AddField(section.num_missing_at_luff);
  csv->AddField(section.num_missing_at_leech);
  csv->AddField("");  // reason
  csv->AddField(section.reaches_luff ? 1 : 0);
  csv->AddField(section.reaches_leech ? 1 : 0);
  csv->EndRecord();
}

void WriteMissingRecord(const MissingSection& missing, CsvWriter* csv) {
  constexpr std::size_t kNumEmpty = 2 + 2 * std::tuple_size_v<decltype(SectionColumns({}))> + 3;
  csv->AddField(missing.part);
  csv->AddField(missing.name);
  for (std::size_t i = 0; i < kNumEmpty; ++i) csv->AddField("");
  csv->AddField(missing.reason);
  for (int i = 0; i < 2; ++i) csv->AddField("");
  csv->EndRecord();
}

}  // namespace

void WriteSectionsCsv(const SectionReport& report, std::ostream& out) {
  CsvWriter csv(out);
  for (const char* key : {"part", "section", "height_m", "num_markers"}) csv.AddField(key);
  for (const SectionColumn& column : SectionColumns({})) {
    csv.AddField(column.file_key);
    csv.AddField(fmt::format("sigma_{}", column.file_key));
  }
  for (const char* key : {"residual_rms_mm", "num_missing_at_luff", "num_missing_at_leech",
                          "reason", "reaches_luff", "reaches_leech"}) {
    csv.AddField(key);
  }
  csv.EndRecord();
  for (const Section& section : report.sections) WriteSectionRecord(section, &csv);
  for (const MissingSection& missing : report.missing) WriteMissingRecord(missing, &csv);
}

void WriteSectionsJson(const SectionReport& report, const ShapeFrame& frame, std::ostream& out) {
  Json root;
  root["frame"] = {
      {"name", frame.name}, {"description", frame.description}, {"reasons", frame.reasons}};
  root["notes"] = report.notes;
  root["sections"] = Json::array();
  for (const Section& section : report.sections) {
    Json object = {
        {"part", section.part}, {"section", section.name}, {"height_m", section.height_m}};
    for (const SectionColumn& column : SectionColumns(section)) {
      AddKeys(column.file_key, column.estimate, &object);
    }
    object["num_missing_at_luff"] = section.num_missing_at_luff;
    object["num_missing_at_leech"] = section.num_missing_at_leech;
    object["reaches_luff"] = section.reaches_luff;
    object["reaches_leech"] = section.reaches_leech;
    if (section.is_line) {
      object["num_effective_parameters"] = section.num_effective_parameters;
      object["residual_rms_mm"] = ResidualRmsMm(section);
      object["markers"] = Json::array();
      for (const SectionMarker& marker : section.markers) {
        object["markers"].push_back(
            {{"marker_id", marker.marker_id}, {"residual_mm", kMmPerM * marker.residual_m}});
      }
    }
    root["sections"].push_back(std::move(object));
  }
  root["rigs"] = Json::array();
  for (const RigNumbers& rig : report.rigs) root["rigs"].push_back(RigJson(rig));
  root["missing"] = Json::array();
  for (const MissingSection& missing : report.missing) {
    root["missing"].push_back(
        {{"part", missing.part}, {"section", missing.name}, {"reason", missing.reason}});
  }
  out << JsonText(root, 2) << '\n';
}

void WriteSectionProfilesCsv(const SectionReport& report, std::ostream& out) {
  CsvWriter csv(out);
  csv.WriteRecord("part", "section", "marker_id", "x", "y", "z", "chordwise_mm", "depth_mm");
  for (const Section& section : report.sections) {
    const auto write = [&](const std::optional<int>& marker_id, const ProfilePoint& point) {
      const Eigen::Vector3d& x = point.x_in_frame_m;
      csv.WriteRecord(section.part, section.name, marker_id, x.x(), x.y(), x.z(),
                      kMmPerM * point.chordwise_m, kMmPerM * point.depth_m);
    };
    for (const ProfilePoint& point : SampleProfile(section, kNumProfilePoints)) {
      write(std::nullopt, point);
    }
    for (const SectionMarker& marker : section.markers) {
      write(marker.marker_id, ProfilePointOf(section, marker.x_in_frame_m));
    }
  }
}

}  // namespace velamap
