// The markers of a plan as a camera sees them: their size in pixels, how many the importer finds at
// that size, and how precisely.

#pragma once

#include <vector>

#include "importer/camera/camera.h"
#include "importer/geometry/quad.h"
#include "importer/geometry/rigid3.h"
#include "workflows/plan/plan_surface.h"

namespace velamap {

// An arc around the middle of the markers at constant height, from one end to the other.
struct PlannedPath {
  double distance_m = 0.0;  // horizontally, from the middle of the markers
  double arc_deg = 0.0;
  double height_m = 0.0;  // of the camera over the lowest marker
  int num_views = 0;
};

// How far the lowest marker is below the middle of all, m.
double LowestDepth(const PlannedSurface& surface);

// The cam_from_plan pose at an angle to the right of straight ahead, looking at the middle of the
// markers.
Rigid3 CameraAt(const PlannedSurface& surface, const PlannedPath& path, double angle_deg);

std::vector<double> AnglesOf(const PlannedPath& path);  // degrees, of its views

// A marker wholly in the picture that shows its face.
struct MarkerView {
  int marker_id = 0;
  QuadCorners corners_in_image_px;
  double side_px = 0.0;      // root of the area
  double narrow_px = 0.0;    // area / longest side: the height of an oblique view
  double found_share = 0.0;  // of such views: those in which the importer finds the marker
};

std::vector<MarkerView> SeeMarkers(const PlannedSurface& surface, const Camera& camera,
                                   const Rigid3& cam_from_plan);

// The markers whose face a view would show, but that are not wholly in its picture.
std::vector<int> MarkersOutsidePicture(const PlannedSurface& surface, const Camera& camera,
                                       const Rigid3& cam_from_plan);

// Figures of one view, or of several together.
struct ViewSummary {
  double in_picture_share = 0.0;  // of the markers
  double found_share = 0.0;       // of the markers, in the picture or not
  double median_side_px = 0.0;    // of the markers in the picture; 0: none
  double median_narrow_px = 0.0;
};

ViewSummary Summarize(const PlannedSurface& surface,
                      const std::vector<std::vector<MarkerView>>& views);

// MarkerView::narrow_px at which a marker is found in half of its views.
double NarrowPxForHalf(int num_cells);

// 1 sigma of a corner's coordinate, px; `corner_sigma_px` is the sigma on a marker of 20 px.
double ExpectedCornerSigma(double corner_sigma_px, double side_px);

// The longest motion of a marker in the picture that is tolerable while the shutter is open: half a
// cell along its narrow side. It loses hardly any markers and a quarter of the corners' precision;
// 1.2 cells lose a fifth of small markers, and 1.5 cells most of them (the table of motions in
// sample_project/guide_sailor.md).
double ToleratedMotionPx(double narrow_px, int num_cells);

}  // namespace velamap
