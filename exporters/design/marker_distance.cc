#include "exporters/design/marker_distance.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

// Axes along the mesh at the foot of the marker, and the unit of length: from the centre of the
// marker to its corners.
struct TangentFrame {
  Eigen::Vector3d origin_m, along, across, normal;
  double radius_m = 0.0;

  Eigen::Vector2d Place(const Eigen::Vector3d& x_m) const {
    const Eigen::Vector3d from_origin = x_m - origin_m;
    return Eigen::Vector2d(from_origin.dot(along), from_origin.dot(across)) / radius_m;
  }
  double Height_m(const Eigen::Vector3d& x_m) const { return (x_m - origin_m).dot(normal); }
};

TangentFrame FrameAt(const MeshFoot& foot, const ShapeMarker& marker) {
  TangentFrame frame;
  frame.origin_m = foot.x_m;
  frame.normal = foot.normal;
  frame.along = foot.normal.unitOrthogonal();
  frame.across = foot.normal.cross(frame.along);
  for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
    frame.radius_m += (*marker.x_in_shape_m[corner] - *marker.x_in_shape_m[0]).norm() / kNumCorners;
  }
  return frame;
}

using Coefficients = Eigen::Matrix<double, 6, 1>;

Coefficients TermsAt(const Eigen::Vector2d& place) {
  const double x = place.x(), y = place.y();
  Coefficients terms;
  terms << 1, x, y, x * x, x * y, y * y;
  return terms;
}

// Fits heights of the second degree to the mesh around the foot, up to the distance of the corners.
// A single facet at the foot would not show the bend, and at the border of the mesh there is a
// surface on one side only.
Coefficients FitHeights(const MeshDistance& mesh, const TangentFrame& frame) {
  constexpr int kNumRings = 3, kNumDirections = 16;
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Coefficients right = Coefficients::Zero();
  int num_samples = 0;
  const auto add = [&](const Eigen::Vector3d& x_m) {
    const MeshFoot sample = mesh.Project(x_m);
    const double height_m = frame.Height_m(sample.x_m);
    // Skips samples beside the mesh or on another side of a fold.
    if (!sample.IsOverSurface(mesh.Diagonal_m()) || std::abs(height_m) > frame.radius_m) return;
    const Coefficients terms = TermsAt(frame.Place(sample.x_m));
    normal += terms * terms.transpose();
    right += height_m * terms;
    ++num_samples;
  };
  add(frame.origin_m);
  for (int ring = 1; ring <= kNumRings; ++ring) {
    for (int i = 0; i < kNumDirections; ++i) {
      const double angle = 2 * kPi * i / kNumDirections, r_m = frame.radius_m * ring / kNumRings;
      add(frame.origin_m + r_m * (std::cos(angle) * frame.along + std::sin(angle) * frame.across));
    }
  }
  if (num_samples < normal.rows()) return Coefficients::Zero();
  // Keeps terms at zero that the samples leave undetermined, as along a strip; hardly changes
  // others.
  normal.diagonal().array() += 1e-8 * num_samples;
  return normal.ldlt().solve(right);
}

}  // namespace

MeshFoot ProjectMarker(const MeshDistance& mesh, const ShapeMarker& whole_marker) {
  MeshFoot foot = mesh.Project(*whole_marker.x_in_shape_m[0]);
  const TangentFrame frame = FrameAt(foot, whole_marker);
  if (!(frame.radius_m > 0)) return foot;
  const Coefficients heights = FitHeights(mesh, frame);
  for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
    const Eigen::Vector2d place = frame.Place(*whole_marker.x_in_shape_m[corner]);
    foot.distance_m -= heights.dot(TermsAt(place)) / kNumCorners;
  }
  return foot;
}

}  // namespace velamap
