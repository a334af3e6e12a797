// A scale audit in figures and in words. The keys and what they mean stand in the README of this
// room.

#pragma once

#include <iosfwd>

#include "exporters/formats/metrics_report.h"
#include "exporters/scale/metric_scale.h"
#include "exporters/scale/scale_audit.h"

namespace velamap {

// Figures of the markers' scales, x against y, spread and known distances. Tables scale_histogram,
// disagreeing_markers, scale_markers, scale_parts, scale_sizes, known_distances.
void AddMetrics(const ScaleAudit& audit, MetricsReport* report);

// The short form for a summary, `key: value` in at most four lines: what the scale's sigma is,
// which markers disagree, the part that differs most from the others, known distances.
void PrintScaleAudit(const ScaleEstimate& scale, const ScaleAudit& audit, std::ostream& out);

}  // namespace velamap
