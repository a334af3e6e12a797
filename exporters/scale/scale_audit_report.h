// Reports of a scale audit. README.md of this room lists the keys.

#pragma once

#include <iosfwd>

#include "exporters/formats/metrics_report.h"
#include "exporters/scale/metric_scale.h"
#include "exporters/scale/scale_audit.h"

namespace velamap {

// Adds the figures of the audit and the tables scale_histogram, disagreeing_markers, scale_markers,
// scale_parts, scale_sizes and known_distances.
void AddMetrics(const ScaleAudit& audit, MetricsReport* report);

// Prints at most four lines `key: value` for a summary: the sigma of the scale, the markers that
// disagree, the part that differs most from the others, and the known distances.
void PrintScaleAudit(const ScaleEstimate& scale, const ScaleAudit& audit, std::ostream& out);

}  // namespace velamap
