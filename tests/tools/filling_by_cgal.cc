#include "tests/tools/filling_methods.h"

#include <cstddef>
#include <utility>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Poisson_reconstruction_function.h>
#include <CGAL/Polygon_mesh_processing/fair.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/property_map.h>

namespace velamap {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

// Kazhdan, Bolitho and Hoppe, "Poisson surface reconstruction", 2006. The zero of the function
// along the normal, by bisection.
FillingOffsets ByPoisson(const FillingTask& task) {
  using Oriented = std::pair<Point, Kernel::Vector_3>;
  constexpr double kReach_m = 0.05;
  constexpr int kNumSteps = 40;
  std::vector<Oriented> points;
  for (const FreeformMarker& marker : task.markers) {
    const Eigen::Vector3d& n = marker.normal;
    for (const Eigen::Vector3d& x : marker.corners_in_shape_m) {
      points.emplace_back(Point(x.x(), x.y(), x.z()), Kernel::Vector_3(n.x(), n.y(), n.z()));
    }
  }
  CGAL::Poisson_reconstruction_function<Kernel> function(
      points.begin(), points.end(), CGAL::First_of_pair_property_map<Oriented>(),
      CGAL::Second_of_pair_property_map<Oriented>());
  FillingOffsets offsets_m(task.places_m.size());
  if (!function.compute_implicit_function()) return offsets_m;
  for (std::size_t i = 0; i < offsets_m.size(); ++i) {
    const auto value_at = [&](double offset_m) {
      const Eigen::Vector3d x = task.places_m[i] + offset_m * task.normals[i];
      return function(Point(x.x(), x.y(), x.z()));
    };
    double low = -kReach_m, high = kReach_m;
    if (!(value_at(low) < 0) || !(value_at(high) > 0)) continue;
    for (int step = 0; step < kNumSteps; ++step) {
      const double middle = (low + high) / 2;
      (value_at(middle) < 0 ? low : high) = middle;
    }
    offsets_m[i] = (low + high) / 2;
  }
  return offsets_m;
}

// Botsch and Kobbelt, "An intuitive framework for real-time freeform modeling", 2004: the vertices
// between the corners get the least bend. One order of continuity more is worse, and slow.
FillingOffsets ByFairing(const FillingTask& task) {
  using Mesh = CGAL::Surface_mesh<Point>;
  Mesh mesh;
  for (std::size_t i = 0; i < task.mesh.vertices_m.size(); ++i) {
    const std::size_t marker = i / kNumCorners;
    const Eigen::Vector3d& x = marker < task.markers.size()
                                   ? task.markers[marker].corners_in_shape_m[i % kNumCorners]
                                   : task.mesh.vertices_m[i];
    mesh.add_vertex(Point(x.x(), x.y(), x.z()));
  }
  const auto vertex = [](std::size_t i) { return Mesh::Vertex_index(static_cast<unsigned>(i)); };
  for (const auto& [a, b, c] : task.mesh.triangles) mesh.add_face(vertex(a), vertex(b), vertex(c));
  std::vector<Mesh::Vertex_index> free;
  for (std::size_t i = 0; i < task.is_given.size(); ++i) {
    if (!task.is_given[i]) free.push_back(vertex(i));
  }
  const bool is_fair = CGAL::Polygon_mesh_processing::fair(mesh, free);
  FillingOffsets offsets_m(task.places_m.size());
  if (!is_fair) return offsets_m;
  std::size_t place = 0;
  for (std::size_t i = 0; i < task.is_given.size(); ++i) {
    if (task.is_given[i]) continue;
    const Point& found = mesh.point(vertex(i));
    const Eigen::Vector3d x(found.x(), found.y(), found.z());
    offsets_m[place] = task.normals[place].dot(x - task.places_m[place]);
    ++place;
  }
  return offsets_m;
}

}  // namespace

void AddCgalMethods(std::vector<FillingMethod>* methods) {
  methods->push_back({"CGAL Poisson", true, ByPoisson});
  methods->push_back({"CGAL fairing", true, ByFairing});
}

}  // namespace velamap
