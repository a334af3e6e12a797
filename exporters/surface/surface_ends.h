// Where a surface ends: at the edges of the cloth, where options or layout name them, or else at
// the outer markers.

#pragma once

#include <map>
#include <string>
#include <vector>

#include "exporters/surface/surface.h"
#include "exporters/surface/surface_smoother.h"

namespace velamap {

struct SortedInput {
  std::vector<SurfaceLine> lines;      // those with enough markers
  std::vector<SurfaceMarker> markers;  // those on no such line
  std::map<int, SurfaceMarker> by_id;  // all of them
  std::vector<std::string> notes;
};

// Returns the options with the ends of the layout where they name none themselves. In `sorted`, it
// removes the lines' distances to the edge that do not apply, because an option replaces them or
// the edge is too far away, and notes the edges that the surface cannot reach.
SurfaceOptions WithEdgesOf(const SurfaceInput& input, const SurfaceOptions& options,
                           SortedInput* sorted);

// Points of all four edges.
std::vector<SurfaceEdgePoint> EdgesOf(const SmoothSurface& smooth);

// Says how well the surface is known where it continues beyond its markers.
void NoteEdges(const SortedInput& sorted, const SurfaceOptions& ends,
               const std::vector<SurfaceEdgePoint>& edges, std::vector<std::string>* notes);

}  // namespace velamap
