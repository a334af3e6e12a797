#include "exporters/sail/sail_metrics.h"

#include <utility>

#include "importer/geometry/units.h"

namespace velamap {

std::array<SectionColumn, 8> SectionColumns(const Section& section) {
  return {{{"chord_m", "chord", "m", 1.0, section.chord_m},
           {"camber", "camber", "percent", 100.0, section.camber},
           {"draft_position", "draft", "percent", 100.0, section.draft_position},
           {"entry_angle_deg", "entry_angle", "deg", 1.0, section.entry_angle_deg},
           {"exit_angle_deg", "exit_angle", "deg", 1.0, section.exit_angle_deg},
           {"twist_deg", "twist", "deg", 1.0, section.twist_deg},
           {"leech_twist_deg", "leech_twist", "deg", 1.0, section.leech_twist_deg},
           {"girth_m", "girth", "m", 1.0, section.girth_m}}};
}

MetricTable SectionTable(const std::vector<Section>& sections) {
  MetricTable table{"sections", true, {}};
  for (const Section& section : sections) {
    Metrics row = {
        {"part", section.part}, {"section", section.name}, {"height_m", section.height_m}};
    for (const SectionColumn& column : SectionColumns(section)) {
      AddEstimate(column.name, column.unit, column.estimate, column.factor, &row);
    }
    row.push_back({"num_missing_at_luff", section.num_missing_at_luff});
    row.push_back({"num_missing_at_leech", section.num_missing_at_leech});
    table.rows.push_back(std::move(row));
  }
  return table;
}

MetricTable RigTable(const std::vector<RigNumbers>& rigs) {
  MetricTable table{"rigs", true, {}};
  for (const RigNumbers& rig : rigs) {
    Metrics row = {{"part", rig.part}};
    AddEstimate("luff_bend", "mm", rig.luff_bend_m, kMmPerM, &row);
    AddEstimate("luff_sag", "mm", rig.luff_sag_m, kMmPerM, &row);
    AddEstimate("sheeting_angle", "deg", rig.sheeting_angle_deg, 1.0, &row);
    if (row.size() > 1) table.rows.push_back(std::move(row));
  }
  return table;
}

void AddMetrics(const SailShape& sail, MetricsReport* report) {
  AddTexts("section_notes", sail.sections.notes, &report->metrics);
  if (MetricTable rigs = RigTable(sail.sections.rigs); !rigs.rows.empty()) {
    report->tables.push_back(std::move(rigs));
  }
  AddTexts("surface_notes", sail.surface_notes, &report->metrics);
  if (sail.surfaces.empty()) return;
  MetricTable table{"surfaces", true, {}};
  for (const SailSurface& surface : sail.surfaces) {
    table.rows.push_back({{"part", surface.part}, {"area_m2", surface.area_m2}});
    if (surface.rms_sigma_m) {
      table.rows.back().push_back({"surface_sigma_mm", kMmPerM * *surface.rms_sigma_m});
    }
    table.rows.back().push_back({"distance_mm", Scaled(kMmPerM, surface.fit.distance_m)});
  }
  report->tables.push_back(std::move(table));
}

}  // namespace velamap
