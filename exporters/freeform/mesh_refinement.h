// Divides the triangles of a coarse mesh on a curved surface.

#pragma once

#include <functional>
#include <vector>

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

// How long an edge is, over the length that it may have.
using EdgeMeasure = std::function<double(const TriangleMesh& mesh, int vertex1, int vertex2)>;

// The point of the surface near a point, and the outward unit normal there. Throws DataError if
// there is none.
struct SurfacePoint {
  Eigen::Vector3d x_in_shape_m, normal;
};
using NearSurface =
    std::function<SurfacePoint(const Eigen::Vector3d& x_in_shape_m, double reach_m)>;

// Halves edges, the longest ones first, until none has a measure above 1 or the mesh has more than
// `max_triangles`. Triangles with one, two or three halved edges become two, three or four. New
// vertices are moved to the surface on up to `num_threads` threads (0: one per core); their sigmas,
// if the mesh has any, are the means of those at the ends. The mesh has to have normals. Throws
// DataError if that does not end, because `measure` does not shrink with the edges.
TriangleMesh RefineMesh(TriangleMesh mesh, const EdgeMeasure& measure,
                        const NearSurface& near_surface, std::size_t max_triangles,
                        int num_threads);

// How many triangles that takes about. Those that are long in one direction are divided along it.
double EstimateNumTriangles(const TriangleMesh& mesh, const EdgeMeasure& measure);

}  // namespace velamap
