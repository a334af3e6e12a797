// A boat to compare with: a cambered sail in lines over a hull of six markers, and meshes in closed
// form.

#pragma once

#include <set>
#include <string>

#include "exporters/formats/mesh_triangles.h"
#include "exporters/shape/marker_shape.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/layout.h"

namespace velamap {

// Sail: lines h1..h5 of six markers each, 11..16 to 51..56; hull, the reference part: 120..125.
Layout BoatLayout();

// On the sail's own surface, x aft, y to leeward, z up, m. Corners and centres have a sigma where
// `sigma_m` is positive.
MarkerShape BoatShape(double sigma_m = 0.0);

// The surface that the sail's markers are on, cut to `margin_m` beyond the outer centres.
TriangleMesh SailMesh(double margin_m = 0.3);

MarkerShape Moved(const Rigid3& b_from_a, MarkerShape shape);
// The markers of these ids by `shift_m`, the others stay.
MarkerShape Shifted(const std::set<int>& ids, const Eigen::Vector3d& shift_m, MarkerShape shape);
// Ids of a part of BoatLayout().
std::set<int> IdsOf(const std::string& part);

// A turn of 70 degrees and a shift of metres.
Rigid3 FarPose();

// A square of side 2 half_m in the plane z = 0, looking to +z, in cells.
TriangleMesh PlaneMesh(double half_m, int num_cells);
// Looking outwards, centre in the origin; closed.
TriangleMesh SphereMesh(double radius_m, int num_rings);

}  // namespace velamap
