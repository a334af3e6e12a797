// A sail of a dinghy and a linear camera, planned.

#pragma once

#include "importer/camera/camera.h"
#include "importer/layout/layout.h"
#include "importer/print/placement.h"
#include "workflows/plan/plan_surface.h"

namespace velamap {

inline Camera LinearCamera() { return {CameraModel::kPinhole, 1920, 1080, {1000, 1000, 960, 540}}; }

inline PlannedSurface PlannedSail(double camber = 0.1) {
  SailPlacementOptions sail;
  sail.luff_m = 4;
  sail.foot_m = 2;
  sail.leech_m = 4.2;
  sail.num_lines = 4;
  sail.markers_per_line = 6;
  const Placement placement = PlaceOnSail(sail, 100, 150, 0);
  Layout layout = MakeLayout("DICT_4X4_250", 0.1);
  layout.parts = {PartOfPlacement(placement), RigidPart("hull", 100, 4)};
  return SurfaceOfPlacement(placement, layout, camber, 10);
}

}  // namespace velamap
