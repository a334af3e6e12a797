#include "exporters/freeform/mesh_refinement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "importer/base/error.h"
#include "importer/base/parallel.h"

namespace velamap {
namespace {

// A round halves only edges whose measure exceeds this fraction of the largest one, so that
// triangles do not become slender.
constexpr double kLongest = 0.7;

using Edge = std::pair<int, int>;
using Middles = std::map<Edge, int>;  // the vertex that halves each edge; see Sorted()

Edge Sorted(int a, int b) { return std::minmax(a, b); }

struct LongEdges {
  Middles middles;
  double longest = 0.0;  // the largest measure of an edge
};

LongEdges FindLongEdges(const TriangleMesh& mesh, const EdgeMeasure& measure) {
  std::vector<std::pair<double, Edge>> too_long;  // inner edges occur twice
  LongEdges found;
  for (const auto& [a, b, c] : mesh.triangles) {
    for (const Edge& edge : {Sorted(a, b), Sorted(b, c), Sorted(c, a)}) {
      const double value = measure(mesh, edge.first, edge.second);
      found.longest = std::max(found.longest, value);
      if (value > 1.0) too_long.emplace_back(value, edge);
    }
  }
  for (const auto& [value, edge] : too_long) {
    if (value > kLongest * found.longest) found.middles.emplace(edge, -1);
  }
  return found;
}

void AddMiddles(const NearSurface& near_surface, int num_threads, Middles* middles,
                TriangleMesh* grown) {
  TriangleMesh& mesh = *grown;
  std::vector<Edge> edges;
  const std::size_t first = mesh.vertices_m.size();
  for (auto& [edge, vertex] : *middles) {
    vertex = static_cast<int>(first + edges.size());
    edges.push_back(edge);
    if (mesh.sigmas_m.empty()) continue;
    mesh.sigmas_m.push_back((mesh.sigmas_m[edge.first] + mesh.sigmas_m[edge.second]) / 2);
  }
  mesh.vertices_m.resize(first + edges.size());
  mesh.normals.resize(first + edges.size());
  ParallelFor(edges.size(), num_threads, [&](std::size_t i) {
    const Eigen::Vector3d &a = mesh.vertices_m[edges[i].first],
                          &b = mesh.vertices_m[edges[i].second];
    const SurfacePoint point = near_surface((a + b) / 2, (b - a).norm());
    mesh.vertices_m[first + i] = point.x_in_shape_m;
    mesh.normals[first + i] = point.normal;
  });
}

// Divides a triangle, some of whose sides may be halved.
std::vector<std::array<int, 3>> Divide(std::array<int, 3> t, const Middles& middles,
                                       const std::vector<Eigen::Vector3d>& x) {
  const auto middle = [&middles](int a, int b) {
    const auto found = middles.find(Sorted(a, b));
    return found == middles.end() ? -1 : found->second;
  };
  std::array<int, 3> m = {middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])};
  const auto num_halved = std::count_if(m.begin(), m.end(), [](int vertex) { return vertex >= 0; });
  if (num_halved == 0) return {t};
  if (num_halved == 3) {
    return {{t[0], m[0], m[2]}, {m[0], t[1], m[1]}, {m[2], m[1], t[2]}, {m[0], m[1], m[2]}};
  }
  // Rotates the triangle so that side 0 is the one that differs from the other two.
  while ((m[0] >= 0) != (num_halved == 1)) {
    std::rotate(t.begin(), t.begin() + 1, t.end());
    std::rotate(m.begin(), m.begin() + 1, m.end());
  }
  if (num_halved == 1) return {{t[0], m[0], t[2]}, {m[0], t[1], t[2]}};
  // Sides 1 and 2 are halved. The shorter diagonal divides the remaining quadrilateral.
  const std::array<int, 3> tip = {m[2], m[1], t[2]};
  if ((x[t[0]] - x[m[1]]).norm() < (x[t[1]] - x[m[2]]).norm()) {
    return {tip, {t[0], t[1], m[1]}, {t[0], m[1], m[2]}};
  }
  return {tip, {t[0], t[1], m[2]}, {t[1], m[1], m[2]}};
}

}  // namespace

TriangleMesh RefineMesh(TriangleMesh mesh, const EdgeMeasure& measure,
                        const NearSurface& near_surface, std::size_t max_triangles,
                        int num_threads) {
  // One or two rounds usually reduce the largest measure to the fraction kLongest.
  constexpr int kMaxRoundsWithoutProgress = 12;
  constexpr double kProgress = 0.95;
  double shortest_so_far = std::numeric_limits<double>::infinity();
  for (int num_idle = 0; mesh.triangles.size() <= max_triangles; ++num_idle) {
    auto [middles, longest] = FindLongEdges(mesh, measure);
    if (middles.empty()) break;
    if (longest < kProgress * shortest_so_far) {
      shortest_so_far = longest;
      num_idle = 0;
    }
    if (num_idle == kMaxRoundsWithoutProgress) {
      throw DataError("the triangles cannot be divided that finely; allow larger ones");
    }
    AddMiddles(near_surface, num_threads, &middles, &mesh);
    std::vector<std::array<int, 3>> divided;
    for (const auto& triangle : mesh.triangles) {
      for (const auto& part : Divide(triangle, middles, mesh.vertices_m)) divided.push_back(part);
    }
    mesh.triangles = std::move(divided);
  }
  return mesh;
}

double EstimateNumTriangles(const TriangleMesh& mesh, const EdgeMeasure& measure) {
  const double unit_area = std::sqrt(3.0) / 4;  // of a triangle whose sides have a measure of 1
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const double ab = measure(mesh, a, b), bc = measure(mesh, b, c), ca = measure(mesh, c, a);
    const double half = (ab + bc + ca) / 2;  // Heron's formula; measures need not form a triangle
    const double area = std::sqrt(std::max(0.0, half * (half - ab) * (half - bc) * (half - ca)));
    sum += std::max({1.0, ab, bc, ca, area / unit_area});
  }
  return sum;
}

}  // namespace velamap
