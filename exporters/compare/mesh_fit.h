// Lays a shape onto a surface: iterated nearest points, each pulled along the surface's normal
// (Chen and Medioni, "Object modelling by registration of multiple range images", Image and Vision
// Computing 10(3), 1992), with Tukey's weights so that parts that differ do not pull the rest
// along, from several starts because the nearest points of a bad start lead nowhere.

#pragma once

#include "exporters/compare/mesh_distance.h"
#include "exporters/compare/shape_alignment.h"
#include "exporters/shape/marker_shape.h"

namespace velamap {

// By all corners; kBestFit or kNone (kAuto: best fit). Points whose foot is on the mesh's border do
// not count in the end: the surface is not where they are (Turk and Levoy, "Zippered polygon meshes
// from range images", SIGGRAPH 1994). Starts: the frames as they are, and all 24 ways to lay the
// principal axes of the markers onto those of the surface (`starts_as_is`: the first only). Notes
// say which motions the surface leaves open, and when another pose fits as well.
// Throws DataError with fewer than six corners, or when nothing comes to lie over the surface;
// InputError for the other methods, which need markers in the reference.
Alignment AlignToMesh(const MarkerShape& shape, const MeshDistance& mesh,
                      const AlignmentOptions& options);

}  // namespace velamap
