// The numbers of a sail for tables: their keys and units are declared here once, for the files of
// sections, the metrics and the report. exporters/formats/README.md explains the keys.

#pragma once

#include <array>
#include <optional>
#include <vector>

#include "exporters/formats/metrics_report.h"
#include "exporters/sail/sail_shape.h"

namespace velamap {

struct SectionColumn {
  const char* file_key;  // in sections.csv and sections.json, which have the unit of `estimate`
  const char* name;      // in metrics and in the report, where `unit` follows
  const char* unit;
  double factor;  // from the unit of `estimate` to `unit`
  std::optional<Estimate> estimate;
};

// The numbers of a section in the order of their columns.
std::array<SectionColumn, 8> SectionColumns(const Section& section);

// The table sections: part, section, height_m, the numbers, num_missing_at_luff and
// num_missing_at_leech.
MetricTable SectionTable(const std::vector<Section>& sections);

// The table rigs: the parts about which something is known.
MetricTable RigTable(const std::vector<RigNumbers>& rigs);

// Adds section_notes, surface_notes and tables rigs and surfaces. The sections have their own
// files.
void AddMetrics(const SailShape& sail, MetricsReport* report);

}  // namespace velamap
