// Divides the triangles of a coarse mesh on a curved surface.

#pragma once

#include <functional>

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

// The length of an edge divided by the length that it may have.
using EdgeMeasure = std::function<double(const TriangleMesh& mesh, int vertex1, int vertex2)>;

struct SurfacePoint {
  Eigen::Vector3d x_in_shape_m, normal;  // outward unit normal
};
// Returns the point of the surface near a given point. Throws DataError if there is none within
// `reach_m`.
using NearSurface =
    std::function<SurfacePoint(const Eigen::Vector3d& x_in_shape_m, double reach_m)>;

// Halves edges, the longest first, until none has a measure above 1 or the mesh has more than
// `max_triangles`. Triangles with one, two or three halved edges become two, three or four
// triangles. The mesh must have normals. New vertices are projected onto the surface with up to
// `num_threads` threads (0: one per core). If the mesh has sigmas, a new vertex gets the mean of
// those at the ends of its edge. Throws DataError if the measures stop decreasing although the
// edges are halved.
TriangleMesh RefineMesh(TriangleMesh mesh, const EdgeMeasure& measure,
                        const NearSurface& near_surface, std::size_t max_triangles,
                        int num_threads);

// Estimates the number of triangles that RefineMesh() would make. It takes into account that a
// slender triangle is divided along its longer direction only.
double EstimateNumTriangles(const TriangleMesh& mesh, const EdgeMeasure& measure);

}  // namespace velamap
