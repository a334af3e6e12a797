#include "exporters/freeform/marker_front.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <set>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "importer/geometry/disjoint_sets.h"
#include "importer/geometry/quad.h"

namespace velamap {
namespace {

using Edge = std::pair<int, int>;

// The cosine of the largest angle between the normals at the ends of an edge, and of the largest
// angle between the normal of a triangle and the normals at its corners.
constexpr double kMinNormalCosine = 0.25, kMinTriangleCosine = 0.4;
// The largest radius of a circumscribed circle divided by the spacing of the markers. A missing
// marker in a square grid leaves a hole with a ratio of 1.
constexpr double kMaxRadiusPerSpacing = 1.5;
constexpr double kTouching = 1e-9;  // fraction of the length of an edge, or for areas of its square

// The distance within which nine tenths of the markers have at least four others, m.
double Spacing(const std::vector<FrontMarker>& markers) {
  constexpr std::size_t kNumNeighbors = 4;
  constexpr double kMost = 0.9;
  std::vector<Eigen::Vector3d> centers;
  for (const FrontMarker& marker : markers) {
    const auto& x = marker.corners_in_shape_m;
    centers.push_back((x[0] + x[1] + x[2] + x[3]) / 4);
  }
  std::vector<double> spacings_m;
  for (const Eigen::Vector3d& center : centers) {
    std::vector<double> distances_m;
    for (const Eigen::Vector3d& other : centers) distances_m.push_back((other - center).norm());
    std::sort(distances_m.begin(), distances_m.end());  // starts with the marker itself
    spacings_m.push_back(distances_m[std::min(kNumNeighbors, distances_m.size() - 1)]);
  }
  std::sort(spacings_m.begin(), spacings_m.end());
  return spacings_m[static_cast<std::size_t>(kMost * static_cast<double>(spacings_m.size() - 1))];
}

class Front {
 public:
  explicit Front(const std::vector<FrontMarker>& markers) {
    for (const FrontMarker& marker : markers) {
      x_.insert(x_.end(), marker.corners_in_shape_m.begin(), marker.corners_in_shape_m.end());
      normals_.insert(normals_.end(), marker.normals.begin(), marker.normals.end());
    }
    neighbors_.resize(x_.size());
    num_open_.resize(x_.size());
    max_radius_m_ = kMaxRadiusPerSpacing * Spacing(markers);
    for (std::size_t i = 0; i < markers.size(); ++i) {
      const int first = kNumCorners * static_cast<int>(i);
      Insert({first, first + 3, first + 2});
      Insert({first, first + 2, first + 1});
    }
    // Edges are queued after all markers are inserted, because any marker may be the best to join.
    const std::vector<std::array<int, 3>> squares = triangles_;
    for (const auto& triangle : squares) QueueOpenSides(triangle);
  }

  std::vector<std::array<int, 3>> Join() {
    while (!queue_.empty()) {
      const Candidate candidate = queue_.top();
      queue_.pop();
      if (!IsOpen(candidate.edge)) continue;
      // The front may have moved since the candidate was found.
      const std::optional<Candidate> best = BestFor(candidate.edge);
      if (!best) continue;
      if (best->vertex == candidate.vertex) {
        Add({best->edge.first, best->edge.second, best->vertex});
      } else {
        queue_.push(*best);
      }
    }
    return std::move(triangles_);
  }

 private:
  struct Candidate {
    double radius_m = 0.0;  // of the circle through the three corners
    Edge edge;              // the side of the new triangle that is on the front
    int vertex = -1;
    bool operator>(const Candidate& other) const {
      return std::tie(radius_m, edge, vertex) > std::tie(other.radius_m, other.edge, other.vertex);
    }
  };

  // The tangent plane at an edge, with x along the edge from its first corner.
  struct Plane {
    Eigen::Vector3d origin, x, y;
    Eigen::Vector2d operator()(const Eigen::Vector3d& point) const {
      return {x.dot(point - origin), y.dot(point - origin)};
    }
  };

  bool IsUsed(const Edge& edge) const { return used_.count(edge) > 0; }
  // Whether there is a triangle on the other side of the edge but none on this side.
  bool IsOpen(const Edge& edge) const { return !IsUsed(edge) && IsUsed({edge.second, edge.first}); }

  void Add(const std::array<int, 3>& triangle) {
    Insert(triangle);
    QueueOpenSides(triangle);
  }

  void Insert(const std::array<int, 3>& triangle) {
    triangles_.push_back(triangle);
    for (int i = 0; i < 3; ++i) {
      const int a = triangle[i], b = triangle[(i + 1) % 3];
      used_.insert({a, b});
      neighbors_[a].insert(b);
      neighbors_[b].insert(a);
      const int change = IsUsed({b, a}) ? -1 : 1;
      num_open_[a] += change;
      num_open_[b] += change;
    }
  }

  void QueueOpenSides(const std::array<int, 3>& triangle) {
    for (int i = 0; i < 3; ++i) {
      const Edge outside = {triangle[(i + 1) % 3], triangle[i]};
      if (!IsOpen(outside)) continue;
      if (const auto candidate = BestFor(outside)) queue_.push(*candidate);
    }
  }

  double Radius(int a, int b, int c) const {
    const Eigen::Vector3d ab = x_[b] - x_[a], ac = x_[c] - x_[a], bc = x_[c] - x_[b];
    const double area_2 = ab.cross(ac).norm();
    return area_2 > 0 ? ab.norm() * ac.norm() * bc.norm() / (2 * area_2)
                      : std::numeric_limits<double>::infinity();
  }

  bool LooksOutward(int a, int b, int c) const {
    const Eigen::Vector3d normal = (x_[b] - x_[a]).cross(x_[c] - x_[a]).normalized();
    return std::min({normal.dot(normals_[a]), normal.dot(normals_[b]), normal.dot(normals_[c])}) >
           kMinTriangleCosine;
  }

  // Whether the side from `a` to `b` would cross a side of an existing triangle.
  bool Crosses(int a, int b, const std::vector<int>& nearby, const Plane& plane) const {
    const Eigen::Vector2d from = plane(x_[a]), along = plane(x_[b]) - from;
    for (const int c : nearby) {
      for (const int d : neighbors_[c]) {
        if (c == a || c == b || d == a || d == b) continue;
        const Eigen::Vector2d start = plane(x_[c]), step = plane(x_[d]) - start;
        if (normals_[d].dot(normals_[c]) < kMinNormalCosine) continue;
        const double of_c = Cross(along, start - from), of_d = Cross(along, start + step - from);
        const double of_a = Cross(step, from - start), of_b = Cross(step, from + along - start);
        if (of_c * of_d < 0 && of_a * of_b < 0) return true;
      }
    }
    return false;
  }

  // Whether another corner lies in the triangle or on one of its sides.
  bool Contains(const std::array<int, 3>& triangle, const std::vector<int>& nearby,
                const Plane& plane) const {
    const auto is_within = [&](int vertex) {
      const Eigen::Vector2d x = plane(x_[vertex]);
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector2d a = plane(x_[triangle[i]]), b = plane(x_[triangle[(i + 1) % 3]]);
        if (Cross(b - a, x - a) < -kTouching * (b - a).squaredNorm()) return false;
      }
      return true;
    };
    return std::any_of(nearby.begin(), nearby.end(), [&](int vertex) {
      return std::find(triangle.begin(), triangle.end(), vertex) == triangle.end() &&
             is_within(vertex);
    });
  }

  // The corners near the middle of an edge with a similar normal, which leaves out those on the
  // other side of a thin body.
  std::vector<int> Nearby(const Eigen::Vector3d& middle, const Eigen::Vector3d& normal) const {
    std::vector<int> nearby;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if ((x_[i] - middle).norm() < 2 * max_radius_m_ &&
          normals_[i].dot(normal) > kMinNormalCosine) {
        nearby.push_back(static_cast<int>(i));
      }
    }
    return nearby;
  }

  bool CanJoin(const Edge& edge, int vertex, const std::vector<int>& nearby,
               const Plane& plane) const {
    const auto [a, b] = edge;
    return num_open_[vertex] > 0 && !IsUsed({b, vertex}) && !IsUsed({vertex, a}) &&
           Radius(a, b, vertex) <= max_radius_m_ && LooksOutward(a, b, vertex) &&
           !Contains({a, b, vertex}, nearby, plane) && !Crosses(b, vertex, nearby, plane) &&
           !Crosses(vertex, a, nearby, plane);
  }

  // The triangle with the smallest circumscribed circle on the open side of the edge: from its
  // third corner, the edge subtends the largest angle.
  std::optional<Candidate> BestFor(const Edge& edge) const {
    const auto [a, b] = edge;
    const Eigen::Vector3d normal = (normals_[a] + normals_[b]).normalized();
    Plane plane;
    plane.origin = x_[a];
    plane.y = normal.cross(x_[b] - x_[a]).normalized();
    plane.x = plane.y.cross(normal);
    const double length_m = plane(x_[b]).x();
    const std::vector<int> nearby = Nearby((x_[a] + x_[b]) / 2, normal);
    std::vector<std::pair<double, int>> by_cotangent;
    for (const int vertex : nearby) {
      const Eigen::Vector2d x = plane(x_[vertex]);
      if (vertex == a || vertex == b || x.y() <= kTouching * length_m) continue;
      by_cotangent.emplace_back((x.x() * (x.x() - length_m) + x.y() * x.y()) / x.y(), vertex);
    }
    std::sort(by_cotangent.begin(), by_cotangent.end());
    for (const auto& [cotangent, vertex] : by_cotangent) {
      if (CanJoin(edge, vertex, nearby, plane))
        return Candidate{Radius(a, b, vertex), edge, vertex};
    }
    return std::nullopt;
  }

  std::vector<Eigen::Vector3d> x_, normals_;
  double max_radius_m_ = 0.0;
  std::vector<std::array<int, 3>> triangles_;
  std::set<Edge> used_;                   // directed sides of the triangles
  std::vector<std::set<int>> neighbors_;  // of each corner
  std::vector<int> num_open_;             // open edges at each corner
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
};

}  // namespace

std::vector<std::array<int, 3>> JoinMarkers(const std::vector<FrontMarker>& markers) {
  return Front(markers).Join();
}

int CountOpenEdges(const std::vector<std::array<int, 3>>& triangles) {
  std::set<Edge> edges;
  for (const auto& [a, b, c] : triangles) {
    for (const Edge& edge : {Edge{a, b}, Edge{b, c}, Edge{c, a}}) {
      if (edges.erase({edge.second, edge.first}) == 0) edges.insert(edge);
    }
  }
  return static_cast<int>(edges.size());
}

std::vector<int> PieceOfVertex(const std::vector<std::array<int, 3>>& triangles,
                               std::size_t num_vertices) {
  DisjointSets sets(num_vertices);
  for (const auto& [a, b, c] : triangles) {
    sets.Join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    sets.Join(static_cast<std::size_t>(a), static_cast<std::size_t>(c));
  }
  std::vector<int> pieces(num_vertices);
  for (std::size_t i = 0; i < num_vertices; ++i) pieces[i] = static_cast<int>(sets.Find(i));
  return pieces;
}

}  // namespace velamap
