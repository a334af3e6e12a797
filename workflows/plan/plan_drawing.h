// A plan as a drawing: the path from above, and the markers with their sigmas from ahead.

#pragma once

#include "importer/print/drawing.h"
#include "workflows/plan/shoot_plan.h"

namespace velamap {

Drawing DrawPlan(const ShootPlan& plan);

}  // namespace velamap
