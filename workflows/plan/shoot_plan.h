// A plan of a shoot: the path, speed and number of views, and the precision that they give.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/report/verdict.h"
#include "importer/base/progress_callback.h"
#include "workflows/plan/plan_options.h"
#include "workflows/plan/plan_precision.h"
#include "workflows/plan/plan_views.h"

namespace velamap {

// What one view sees, from one place.
struct PlannedView {
  double distance_m = 0.0, angle_deg = 0.0;
  ViewSummary summary;
  double exposure_s = 0.0;  // the longest at the planned speed; 0: nothing is seen
};

// The shutter on the planned path.
struct PlannedShutter {
  double speed_m_s = 0.0;
  double motion_px_s = 0.0;  // of a marker in the picture
  double exposure_s = 0.0;   // the longest
};

// The planned path, or one that differs from it in one thing.
struct PlannedVariant {
  std::string changed;  // plan, views, arc or distance
  PlannedPath path;
  std::optional<PlanPrecision> precision;
  std::string failure;  // where the views give no shape
};

// What to do: the planned path, or a better one where that is bad.
struct PlannedRecommendation {
  PlannedPath path;
  PlannedShutter shutter;  // at the planned speed
};

struct ShootPlan {
  Camera camera;
  PlannedSurface surface;
  PlannedPath path;
  ViewSummary along_path;
  std::vector<PlannedView> views;
  // For the end of the arc where markers are narrowest: at the planned speed, half of it, and twice
  // as much.
  std::vector<PlannedShutter> shutters;
  std::vector<PlannedVariant> variants;  // the plan itself is the first

  std::optional<PlannedRecommendation> recommended;  // nothing if no path was found to be better

  const PlannedVariant& plan() const { return variants.front(); }
};

// Throws InputError for a distance at which hardly any marker is found, and where no distance shows
// four markers. `progress` is of the paths that differ from the plan, which take most of the time.
ShootPlan MakeShootPlan(const PlannedSurface& surface, const Camera& camera,
                        const ShootPlanOptions& options, const ProgressCallback& progress = {});

Verdict JudgePlan(const ShootPlan& plan);

}  // namespace velamap
