// Fits a shape to a surface by iterative closest points with distances along the normal of the
// surface (Chen and Medioni, "Object modelling by registration of multiple range images", Image and
// Vision Computing 10(3), 1992). Tukey's weights exclude parts that differ, and several starts
// avoid local minima.

#pragma once

#include "exporters/compare/shape_alignment.h"
#include "exporters/design/mesh_distance.h"
#include "exporters/shape/marker_shape.h"

namespace velamap {

// Aligns all corners with kBestFit (also for kAuto) or kNone. Corners whose foot is on the border
// of the mesh get no weight in the end, because they lie beside the surface (Turk and Levoy,
// "Zippered polygon meshes from range images", SIGGRAPH 1994). The starts are the frames as they
// are and the 24 rotations of the principal axes of the markers to those of the surface
// (`starts_as_is`: the first only). Notes name motions that the surface does not determine and
// other poses with an equal fit. Throws DataError with fewer than six corners or if none lies over
// the surface, and InputError for other methods, which need markers in the reference.
Alignment AlignToMesh(const MarkerShape& shape, const MeshDistance& mesh,
                      const AlignmentOptions& options);

}  // namespace velamap
