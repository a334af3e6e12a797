// A boat for comparisons: a cambered sail with lines over a hull of six markers, and meshes in
// closed form.

#pragma once

#include <functional>
#include <set>
#include <string>

#include "exporters/compare/shape_deviation.h"
#include "exporters/formats/mesh_triangles.h"
#include "exporters/shape/marker_shape.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/layout.h"

namespace velamap {

// Sail: lines h1..h5 of six markers each, 11..16 to 51..56; hull, the reference part: 120..125.
Layout BoatLayout();

// Markers on the surface of the sail; x aft, y to leeward, z up, m. Corners and centres have a
// sigma if `sigma_m` is positive.
MarkerShape BoatShape(double sigma_m = 0.0);

// The same with the markers of the sail stuck to it: their corners lie on its surface, and their
// centres, which are the means of the corners, up to 2 mm beside it.
MarkerShape BentBoatShape(double sigma_m = 0.0);

// The surface of the sail's markers up to `margin_m` beyond the outer centres.
TriangleMesh SailMesh(double margin_m = 0.3);

// A shape without uncertainties, and with those of its sigmas.
UncertainShape Exact(const MarkerShape& shape);
UncertainShape WithSigmas(const MarkerShape& shape);

MarkerShape Moved(const Rigid3& b_from_a, MarkerShape shape);
// Moves the markers with these ids by `shift_m`.
MarkerShape Shifted(const std::set<int>& ids, const Eigen::Vector3d& shift_m, MarkerShape shape);
MarkerShape Without(const std::set<int>& ids, MarkerShape shape);
// Ids of a part of BoatLayout().
std::set<int> IdsOf(const std::string& part);

// The sail again as a second part "jib", in the same place, with ids that are larger by 200.
Layout WithJib(Layout layout);
MarkerShape WithJib(MarkerShape shape);

// A rotation by 70 degrees and a translation by metres.
Rigid3 FarPose();

// A grid of num_u x num_v cells over the unit square, with its vertices at `at`. The normals point
// along the cross product of the derivatives with respect to u and v.
TriangleMesh GridMesh(int num_u, int num_v,
                      const std::function<Eigen::Vector3d(double u, double v)>& at);
// A square of side 2 half_m in the plane z = 0 with normal +z, as a grid of cells.
TriangleMesh PlaneMesh(double half_m, int num_cells);
// A closed sphere about the origin with outward normals.
TriangleMesh SphereMesh(double radius_m, int num_rings);

}  // namespace velamap
