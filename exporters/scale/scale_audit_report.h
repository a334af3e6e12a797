// Reports of a scale audit. exporters/formats/README.md lists the keys.

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "exporters/formats/metrics_report.h"
#include "exporters/scale/metric_scale.h"
#include "exporters/scale/scale_audit.h"

namespace velamap {

// Adds the figures of the audit and the tables scale_histogram, disagreeing_markers, scale_markers,
// scale_parts, scale_sizes and known_distances.
void AddMetrics(const ScaleAudit& audit, MetricsReport* report);

// The distances that the shape fails, CheckedDistance::FailsAsCheck().
std::vector<const CheckedDistance*> FailedChecks(const ScaleAudit& audit);

// Number of distances that check the shape and are in it.
int NumChecks(const ScaleAudit& audit);

// Number of distances that are in the shape.
int NumDistancesFound(const ScaleAudit& audit);

// Among the distances in the shape, the one that is off by the most sigmas. A failed check takes
// precedence over a scale bar that the adjustment used, however far off that is. Null if none.
const CheckedDistance* WorstDistance(const ScaleAudit& audit);

// `12-45.3 +15.10 mm (+5.2 sigmas)` for a distance that is in the shape.
std::string ShortText(const CheckedDistance& checked);

// A warning that names the scale bars which are only checks (CheckedDistance::IsCheck()), and one
// for each distance that the shape fails: its name, its value, how far it is off.
std::vector<std::string> ScaleWarnings(const ScaleAudit& audit);

// Prints at most four lines `key: value` for a summary: the sigma of the scale, the markers that
// disagree, the part that differs most from the others, and the known distances.
void PrintScaleAudit(const ScaleEstimate& scale, const ScaleAudit& audit, std::ostream& out);

}  // namespace velamap
