#include "exporters/design/mesh_distance.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include <BVH_Distance.hxx>
#include <BVH_Tools.hxx>
#include <BVH_Triangulation.hxx>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/geometry/directions.h"

namespace velamap {
namespace {

using Triangles = BVH_Triangulation<double, 3>;
using Triangle = std::array<int, 3>;
using Triple = std::array<Eigen::Vector3d, 3>;

constexpr double kWeldTolerance = 1e-8;  // of the diagonal
constexpr double kMinDirection = 1e-9;   // of the diagonal; rounding turns shorter vectors

// Nearest point of a triangle with its barycentric weights. A weight of exactly 0 means that the
// foot is on the opposite edge or vertex.
struct TriangleFoot {
  std::array<double, 3> weights;
  Eigen::Vector3d x_m;
};

TriangleFoot FootOnEdge(const Triple& corners, int from, int to, double t) {
  TriangleFoot foot{{0.0, 0.0, 0.0}, corners[from] + t * (corners[to] - corners[from])};
  foot.weights[from] = 1 - t;
  foot.weights[to] = t;
  return foot;
}

// Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
TriangleFoot NearestOfTriangle(const Eigen::Vector3d& x, const Triple& c) {
  const Eigen::Vector3d ab = c[1] - c[0], ac = c[2] - c[0];
  const Eigen::Vector3d ax = x - c[0], bx = x - c[1], cx = x - c[2];
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0) return FootOnEdge(c, 0, 1, 0.0);
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) return FootOnEdge(c, 1, 2, 0.0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return FootOnEdge(c, 0, 1, d1 / (d1 - d3));
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) return FootOnEdge(c, 2, 0, 0.0);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return FootOnEdge(c, 0, 2, d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return FootOnEdge(c, 1, 2, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
  }
  const double v = vb / (va + vb + vc), w = vc / (va + vb + vc);
  return {{1 - v - w, v, w}, c[0] + v * ab + w * ac};
}

Eigen::Vector3d ToEigen(const BVH_Vec3d& x) { return {x.x(), x.y(), x.z()}; }

Triple CornersOf(const Triangles& triangles, int idx) {
  const BVH_Vec4i& t = triangles.Elements[static_cast<std::size_t>(idx)];
  const auto vertex = [&](int i) {
    return ToEigen(triangles.Vertices[static_cast<std::size_t>(i)]);
  };
  return {vertex(t.x()), vertex(t.y()), vertex(t.z())};
}

class NearestTriangle : public BVH_Distance<double, 3, BVH_Vec3d, Triangles> {
 public:
  Standard_Boolean RejectNode(const BVH_Vec3d& low, const BVH_Vec3d& high,
                              double& square_distance) const override {
    square_distance = BVH_Tools<double, 3>::PointBoxSquareDistance(myObject, low, high);
    return RejectMetric(square_distance);
  }

  Standard_Boolean Accept(const Standard_Integer idx, const double&) override {
    const TriangleFoot foot = NearestOfTriangle(ToEigen(myObject), CornersOf(*this->myBVHSet, idx));
    const double square_distance = (foot.x_m - ToEigen(myObject)).squaredNorm();
    if (square_distance >= myDistance) return Standard_False;
    myDistance = square_distance;
    nearest_ = idx;
    foot_ = foot;
    return Standard_True;
  }

  int Nearest() const { return nearest_; }
  const TriangleFoot& Foot() const { return foot_; }

 private:
  int nearest_ = -1;
  TriangleFoot foot_{};
};

std::uint64_t EdgeKey(int a, int b) {
  const auto low = static_cast<std::uint64_t>(std::min(a, b));
  return (low << 32) | static_cast<std::uint64_t>(std::max(a, b));
}

struct Edge {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // sum over its triangles
  int num_triangles = 0;
  int direction = 0;  // triangles with ascending minus triangles with descending vertices
};

// Gives vertices in the same place the same number.
std::vector<int> Weld(const std::vector<Eigen::Vector3d>& vertices_m, const Eigen::Vector3d& min_m,
                      double tolerance_m, std::vector<Eigen::Vector3d>* welded_m) {
  std::map<std::array<std::int64_t, 3>, int> cells;
  std::vector<int> numbers;
  for (const Eigen::Vector3d& x : vertices_m) {
    std::array<std::int64_t, 3> cell;
    for (int i = 0; i < 3; ++i) {
      cell[static_cast<std::size_t>(i)] = std::llround((x[i] - min_m[i]) / tolerance_m);
    }
    const auto [it, is_new] = cells.emplace(cell, static_cast<int>(welded_m->size()));
    if (is_new) welded_m->push_back(x);
    numbers.push_back(it->second);
  }
  return numbers;
}

MeshMoments MomentsOf(const Triangles& triangles) {
  const auto area_of = [](const Triple& x) {
    return 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
  };
  MeshMoments moments;
  double sum_m2 = 0.0;
  for (int i = 0; i < triangles.Size(); ++i) {
    const Triple x = CornersOf(triangles, i);
    sum_m2 += area_of(x);
    moments.mean_m += area_of(x) * (x[0] + x[1] + x[2]) / 3;
  }
  moments.mean_m /= sum_m2;
  for (int i = 0; i < triangles.Size(); ++i) {
    const Triple x = CornersOf(triangles, i);
    // Exact for a triangle: the three midpoints of its sides, equally weighted.
    const Triple midpoints = {(x[0] + x[1]) / 2, (x[1] + x[2]) / 2, (x[2] + x[0]) / 2};
    for (const Eigen::Vector3d& midpoint : midpoints) {
      const Eigen::Vector3d from_mean = midpoint - moments.mean_m;
      moments.covariance_m2 += area_of(x) / (3 * sum_m2) * from_mean * from_mean.transpose();
    }
  }
  return moments;
}

}  // namespace

struct MeshDistance::Index {
  Triangles triangles;                          // element: three vertices and 0
  std::vector<Eigen::Vector3d> vertex_normals;  // angle-weighted sums
  std::vector<bool> is_border_vertex;
  std::unordered_map<std::uint64_t, Edge> edges;
  int num_flipped_edges = 0;
  double diagonal_m = 0.0;
  MeshMoments moments;

  void AddTriangle(const Triangle& t);
  void FindBorder();
};

void MeshDistance::Index::AddTriangle(const Triangle& t) {
  const auto vertex = [&](std::size_t k) {
    return ToEigen(triangles.Vertices[static_cast<std::size_t>(t[k % 3])]);
  };
  const Eigen::Vector3d area = (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0));
  if (!(area.norm() > 0)) return;
  const Eigen::Vector3d normal = area.normalized();
  triangles.Elements.push_back(BVH_Vec4i(t[0], t[1], t[2], 0));
  for (std::size_t k = 0; k < 3; ++k) {
    const int from = t[k], to = t[(k + 1) % 3];
    vertex_normals[static_cast<std::size_t>(from)] +=
        AngleBetween(vertex(k + 1) - vertex(k), vertex(k + 2) - vertex(k)) * normal;
    Edge& edge = edges[EdgeKey(from, to)];
    edge.normal += normal;
    ++edge.num_triangles;
    edge.direction += from < to ? 1 : -1;
  }
}

void MeshDistance::Index::FindBorder() {
  is_border_vertex.assign(vertex_normals.size(), false);
  for (const auto& [key, edge] : edges) {
    if (edge.num_triangles == 2 && edge.direction != 0) ++num_flipped_edges;
    if (edge.num_triangles != 1) continue;
    is_border_vertex[static_cast<std::size_t>(key >> 32)] = true;
    is_border_vertex[static_cast<std::size_t>(key & 0xffffffffu)] = true;
  }
}

OptionGroup DescribeOptions(EdgeOptions* options) {
  return {"Edge of a surface",
          {{"edge_tolerance", &options->tolerance_mm, "mm",
            "how far beyond the edge of the reference's surface a marker is still compared, by its "
            "distance along the normal at the edge; at least 3 sigmas of its position",
            AtLeast(0)}}};
}

void EdgeOptions::Check() const { CheckRanges(*this); }

MeshDistance::MeshDistance(const TriangleMesh& mesh) : index_(std::make_unique<Index>()) {
  VELAMAP_CHECK(!mesh.triangles.empty());
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& x : mesh.vertices_m) box.extend(x);
  index_->diagonal_m = box.diagonal().norm();
  VELAMAP_CHECK(index_->diagonal_m > 0);
  std::vector<Eigen::Vector3d> welded_m;
  const std::vector<int> numbers =
      Weld(mesh.vertices_m, box.min(), kWeldTolerance * index_->diagonal_m, &welded_m);
  for (const Eigen::Vector3d& x : welded_m) {
    index_->triangles.Vertices.push_back(BVH_Vec3d(x.x(), x.y(), x.z()));
  }
  index_->vertex_normals.assign(welded_m.size(), Eigen::Vector3d::Zero());
  for (const Triangle& t : mesh.triangles) {
    const auto number = [&](std::size_t k) { return numbers[static_cast<std::size_t>(t[k])]; };
    index_->AddTriangle({number(0), number(1), number(2)});
  }
  VELAMAP_CHECK(!index_->triangles.Elements.empty());
  index_->FindBorder();
  index_->moments = MomentsOf(index_->triangles);
  index_->triangles.MarkDirty();
  index_->triangles.BVH();  // builds it
}

MeshDistance::~MeshDistance() = default;

double MeshDistance::Diagonal_m() const { return index_->diagonal_m; }
const MeshMoments& MeshDistance::Moments() const { return index_->moments; }
int MeshDistance::NumFlippedEdges() const { return index_->num_flipped_edges; }

MeshFoot MeshDistance::Project(const Eigen::Vector3d& x_m) const {
  NearestTriangle search;
  search.SetObject(BVH_Vec3d(x_m.x(), x_m.y(), x_m.z()));
  search.SetBVHSet(&index_->triangles);
  search.ComputeDistance();
  VELAMAP_CHECK(search.Nearest() >= 0);
  const BVH_Vec4i& t = index_->triangles.Elements[static_cast<std::size_t>(search.Nearest())];
  const Triangle vertices = {t.x(), t.y(), t.z()};
  std::vector<int> feature;  // the vertices that the foot is made of
  for (std::size_t k = 0; k < 3; ++k) {
    if (search.Foot().weights[k] != 0) feature.push_back(vertices[k]);
  }
  MeshFoot foot;
  foot.x_m = search.Foot().x_m;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  bool is_on_border = false;
  if (feature.size() == 1) {
    normal = index_->vertex_normals[static_cast<std::size_t>(feature[0])];
    is_on_border = index_->is_border_vertex[static_cast<std::size_t>(feature[0])];
  } else if (feature.size() == 2) {
    const Edge& edge = index_->edges.at(EdgeKey(feature[0], feature[1]));
    normal = edge.normal;
    is_on_border = edge.num_triangles == 1;
  }
  // The foot is within the triangle, or the normals of opposite triangles cancel.
  if (normal.norm() < 1e-6) {
    const auto [a, b, c] = CornersOf(index_->triangles, search.Nearest());
    normal = (b - a).cross(c - a);
  }
  foot.normal = normal.normalized();
  const Eigen::Vector3d from_foot = x_m - foot.x_m;
  const double along = from_foot.dot(foot.normal);
  if (is_on_border) {
    foot.distance_m = along;
    foot.beside_m = (from_foot - along * foot.normal).norm();
  } else {
    foot.distance_m = along < 0 ? -from_foot.norm() : from_foot.norm();
    // The mean of the triangles' normals, which gives the sign, misses the foot by up to the
    // distance times the sine of half the angle between them. A point on the mesh has no direction.
    const bool is_on_mesh = from_foot.norm() < kMinDirection * index_->diagonal_m;
    if (feature.size() < 3 && !is_on_mesh) foot.normal = from_foot / foot.distance_m;
  }
  return foot;
}

}  // namespace velamap
