// The key numbers that judge the size of the shape: its scale, and what was measured by hand.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/report/report_key_numbers.h"

namespace velamap {

// `audit` and `uncertainty` may be null. If the noise of the corners explains why the markers'
// sizes differ, the advice is the warning of weak geometry (weak_geometry.h).
KeyNumber ScaleNumber(const ScaleEstimate& scale, const ScaleAudit* audit,
                      const AdjustmentUncertainty* uncertainty,
                      const std::vector<std::string>& warnings);

// Distances measured by hand. Those that the adjustment used prove nothing, unless it left them
// out. Returns nothing for a layout without distances.
std::optional<KeyNumber> DistancesNumber(const ScaleAudit& audit);

// Coordinates measured by hand: checks decide, then points that contradict the others. Returns
// nothing for a layout without known points.
std::optional<KeyNumber> KnownPointsNumber(const KnownPointFit& fit);

}  // namespace velamap
