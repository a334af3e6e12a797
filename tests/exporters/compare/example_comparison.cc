#include "tests/exporters/compare/example_comparison.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "exporters/compare/comparison_sigma.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr int kNumLines = 5, kNumOnLine = 6;
constexpr int kJibMinusSailId = 200;
constexpr double kFootM = 3.0, kHeightM = 4.0, kMarkerM = 0.1;

// Chord fraction u in 0..1 from luff to leech, height fraction v in 0..1.
Eigen::Vector3d SailPoint(double u, double v) {
  const double chord = kFootM * (1 - 0.5 * v);
  const double twist = 0.2 * v;
  const double depth = 0.45 * chord * u * (1 - u) * (1.4 - 0.6 * u);
  const Eigen::Vector3d across(-std::sin(twist), std::cos(twist), 0);
  const Eigen::Vector3d along(std::cos(twist), std::sin(twist), 0);
  return u * chord * along + depth * across + kHeightM * v * Eigen::Vector3d::UnitZ() +
         0.3 * v * Eigen::Vector3d::UnitX();
}

Eigen::Matrix3d FrameAt(double u, double v) {
  constexpr double kStep = 1e-5;
  const Eigen::Vector3d by_u = SailPoint(u + kStep, v) - SailPoint(u - kStep, v);
  const Eigen::Vector3d by_v = SailPoint(u, v + kStep) - SailPoint(u, v - kStep);
  Eigen::Matrix3d axes;
  axes.col(0) = by_u.normalized();
  axes.col(2) = by_u.cross(by_v).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

ShapeMarker MakeMarker(int id, const std::string& part, const Eigen::Vector3d& center,
                       const Eigen::Matrix3d& axes, double sigma_m) {
  ShapeMarker marker;
  marker.marker_id = id;
  marker.part = part;
  const double signs[4][2] = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
  marker.x_in_shape_m[0] = center;
  for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
    const double* sign = signs[corner - 1];
    marker.x_in_shape_m[corner] =
        center + kMarkerM / 2 * (sign[0] * axes.col(0) + sign[1] * axes.col(1));
  }
  marker.num_frames.fill(10);
  if (sigma_m > 0) {
    marker.sigma_m.fill(Eigen::Vector3d::Constant(sigma_m));
    marker.sigma_m[0] = Eigen::Vector3d::Constant(sigma_m / 2);  // of four independent corners
  }
  return marker;
}

int SailId(int line, int place) { return 10 * (line + 1) + place + 1; }

double PlaceToU(int place) { return 0.05 + 0.9 * place / (kNumOnLine - 1); }
double LineToV(int line) { return line / (kNumLines - 1.0); }

// The nearest point of the sail, from a place near it.
Eigen::Vector3d FootOnSail(const Eigen::Vector3d& x, double u, double v) {
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 20; ++i) {
    Eigen::Matrix<double, 3, 2> tangents;
    tangents.col(0) = (SailPoint(u + kStep, v) - SailPoint(u - kStep, v)) / (2 * kStep);
    tangents.col(1) = (SailPoint(u, v + kStep) - SailPoint(u, v - kStep)) / (2 * kStep);
    const Eigen::Matrix2d normal = tangents.transpose() * tangents;
    const Eigen::Vector2d move = normal.inverse() * (tangents.transpose() * (x - SailPoint(u, v)));
    u += move[0];
    v += move[1];
  }
  return SailPoint(u, v);
}

}  // namespace

Layout BoatLayout() {
  Layout layout;
  layout.marker_length_m = kMarkerM;
  LayoutPart sail{"sail", false, {}, {}, {}};
  for (int line = 0; line < kNumLines; ++line) {
    MarkerLine horizontal{"h" + std::to_string(line + 1), {}};
    for (int place = 0; place < kNumOnLine; ++place) {
      horizontal.marker_ids.push_back(SailId(line, place));
    }
    sail.horizontal.push_back(horizontal);
  }
  layout.parts = {sail, {"hull", true, {}, {}, {120, 121, 122, 123, 124, 125}}};
  layout.reference_part = "hull";
  return layout;
}

MarkerShape BoatShape(double sigma_m) {
  MarkerShape shape;
  for (int line = 0; line < kNumLines; ++line) {
    for (int place = 0; place < kNumOnLine; ++place) {
      const double u = PlaceToU(place), v = LineToV(line);
      shape.markers.push_back(
          MakeMarker(SailId(line, place), "sail", SailPoint(u, v), FrameAt(u, v), sigma_m));
    }
  }
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d center(0.8 * (i % 3), i < 3 ? -0.2 : 0.3, -1.0 - 0.1 * (i % 2));
    shape.markers.push_back(
        MakeMarker(120 + i, "hull", center, Eigen::Matrix3d::Identity(), sigma_m));
  }
  return shape;
}

MarkerShape BentBoatShape(double sigma_m) {
  MarkerShape shape = BoatShape(sigma_m);
  for (ShapeMarker& marker : shape.markers) {
    if (marker.part != "sail") continue;
    const double u = PlaceToU(marker.marker_id % 10 - 1), v = LineToV(marker.marker_id / 10 - 1);
    for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
      Eigen::Vector3d& x = *marker.x_in_shape_m[corner];
      x = FootOnSail(x, u, v);
    }
    marker.x_in_shape_m[0] = MeanOfCorners(marker);
  }
  return shape;
}

TriangleMesh GridMesh(int num_u, int num_v,
                      const std::function<Eigen::Vector3d(double u, double v)>& at) {
  TriangleMesh mesh;
  for (int j = 0; j <= num_v; ++j) {
    for (int i = 0; i <= num_u; ++i) {
      mesh.vertices_m.push_back(at(static_cast<double>(i) / num_u, static_cast<double>(j) / num_v));
    }
  }
  for (int j = 0; j < num_v; ++j) {
    for (int i = 0; i < num_u; ++i) {
      const int a = j * (num_u + 1) + i, b = a + 1, c = a + num_u + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

TriangleMesh SailMesh(double margin_m) {
  constexpr int kCells = 120;
  const double edge_u = margin_m / kFootM, edge_v = margin_m / kHeightM;
  return GridMesh(kCells, kCells, [&](double u, double v) {
    return SailPoint(0.05 - edge_u + (0.9 + 2 * edge_u) * u, -edge_v + (1 + 2 * edge_v) * v);
  });
}

UncertainShape Exact(const MarkerShape& shape) { return {shape, {}}; }

UncertainShape WithSigmas(const MarkerShape& shape) { return {shape, CovarianceFromSigmas(shape)}; }

MarkerShape Moved(const Rigid3& b_from_a, MarkerShape shape) {
  for (ShapeMarker& marker : shape.markers) {
    for (auto& x : marker.x_in_shape_m) {
      if (x) x = b_from_a * *x;
    }
  }
  return shape;
}

MarkerShape Shifted(const std::set<int>& ids, const Eigen::Vector3d& shift_m, MarkerShape shape) {
  for (ShapeMarker& marker : shape.markers) {
    if (ids.count(marker.marker_id) == 0) continue;
    for (auto& x : marker.x_in_shape_m) {
      if (x) *x += shift_m;
    }
  }
  return shape;
}

MarkerShape Without(const std::set<int>& ids, MarkerShape shape) {
  auto& markers = shape.markers;
  markers.erase(std::remove_if(markers.begin(), markers.end(),
                               [&](const auto& m) { return ids.count(m.marker_id) > 0; }),
                markers.end());
  return shape;
}

std::set<int> IdsOf(const std::string& part) {
  std::set<int> ids;
  for (const ShapeMarker& marker : BoatShape().markers) {
    if (marker.part == part) ids.insert(marker.marker_id);
  }
  return ids;
}

Layout WithJib(Layout layout) {
  LayoutPart jib = layout.parts.front();
  jib.name = "jib";
  for (MarkerLine& line : jib.horizontal) {
    for (int& id : line.marker_ids) id += kJibMinusSailId;
  }
  layout.parts.push_back(jib);
  return layout;
}

MarkerShape WithJib(MarkerShape shape) {
  const std::set<int> sail = IdsOf("sail");
  const std::vector<ShapeMarker> markers = shape.markers;
  for (ShapeMarker marker : markers) {
    if (sail.count(marker.marker_id) == 0) continue;
    marker.part = "jib";
    marker.marker_id += kJibMinusSailId;
    shape.markers.push_back(marker);
  }
  return shape;
}

Rigid3 FarPose() {
  return {Eigen::Quaterniond(
              Eigen::AngleAxisd(70 * kRadPerDeg, Eigen::Vector3d(1, -2, 0.5).normalized())),
          {4, -7, 2}};
}

TriangleMesh PlaneMesh(double half_m, int num_cells) {
  return GridMesh(num_cells, num_cells, [&](double u, double v) {
    return Eigen::Vector3d(half_m * (2 * u - 1), half_m * (2 * v - 1), 0.0);
  });
}

TriangleMesh SphereMesh(double radius_m, int num_rings) {
  const int num_around = 2 * num_rings;
  TriangleMesh mesh;
  for (int ring = 0; ring <= num_rings; ++ring) {
    const double polar = kPi * ring / num_rings;
    for (int i = 0; i < num_around; ++i) {
      const double around = 2 * kPi * i / num_around;
      mesh.vertices_m.emplace_back(radius_m * std::sin(polar) * std::cos(around),
                                   radius_m * std::sin(polar) * std::sin(around),
                                   radius_m * std::cos(polar));
    }
  }
  for (int ring = 0; ring < num_rings; ++ring) {
    for (int i = 0; i < num_around; ++i) {
      const int a = ring * num_around + i, b = ring * num_around + (i + 1) % num_around;
      mesh.triangles.push_back({a, a + num_around, b + num_around});
      mesh.triangles.push_back({a, b + num_around, b});
    }
  }
  return mesh;
}

}  // namespace velamap
