#include "exporters/cloth/cloth_places.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/sail/section.h"
#include "importer/geometry/units.h"
#include "tests/exporters/sail/example_surface.h"
#include "tests/support/study/sail_study.h"

namespace velamap {
namespace {

// A random sail with markers that bend with it, nearly without noise.
struct BentSail {
  Surface sail;
  SailLines lines;
  Layout layout;
  MarkerShape shape;
};

void AddMarker(const SurfaceMarker& marker, MarkerShape* shape) {
  ShapeMarker whole;
  whole.marker_id = marker.marker_id;
  whole.part = "sail";
  whole.x_in_shape_m[0] = marker.x_in_shape_m;
  whole.sigma_m.fill(Eigen::Vector3d::Constant(*marker.sigma_m));
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    whole.x_in_shape_m[i + 1] = marker.corners_in_shape_m[i];
  }
  shape->markers.push_back(whole);
}

BentSail DrawBentSail(unsigned seed) {
  std::mt19937 random(seed);
  BentSail bent;
  bent.sail = DrawSail(&random);
  bent.lines = DrawLines(bent.sail, &random);
  const SurfaceInput input = DrawMarkers(bent.sail, bent.lines, 1e-5, &random);
  LayoutPart part;
  part.name = "sail";
  for (const SurfaceLine& line : input.lines) {
    part.horizontal.push_back({line.name, {}});
    for (const auto& marker : line.markers) {
      part.horizontal.back().marker_ids.push_back(marker->marker_id);
      AddMarker(*marker, &bent.shape);
    }
  }
  for (const SurfaceMarker& marker : input.markers) {
    part.marker_ids.push_back(marker.marker_id);
    AddMarker(marker, &bent.shape);
  }
  bent.layout.parts.push_back(part);
  return bent;
}

// Distances of the centres of the lines' markers from the sail, along its normal.
std::vector<double> DistancesFromCloth(const BentSail& bent) {
  constexpr double kStep = 1e-5;
  std::vector<double> distances_m;
  for (std::size_t j = 0; j < bent.lines.vs.size(); ++j) {
    const std::vector<int>& ids = bent.layout.parts[0].horizontal[j].marker_ids;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const double fraction = static_cast<double>(i) / static_cast<double>(ids.size() - 1);
      const double first = bent.lines.first_us[j], last = bent.lines.last_us[j];
      const Eigen::Vector2d uv(first + fraction * (last - first), bent.lines.vs[j]);
      const Eigen::Vector2d du(kStep, 0), dv(0, kStep);
      const Eigen::Vector3d normal = (bent.sail(uv + du) - bent.sail(uv - du))
                                         .cross(bent.sail(uv + dv) - bent.sail(uv - dv))
                                         .normalized();
      const ShapeMarker& marker = *FindWholeMarker(bent.shape, ids[i]);
      distances_m.push_back(normal.dot(*marker.x_in_shape_m[0] - bent.sail(uv)));
    }
  }
  return distances_m;
}

double Largest(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

TEST(ClothPlaces, TheMiddleOfABentMarkerIsOnTheCloth) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    BentSail bent = DrawBentSail(seed);
    const std::vector<double> before_m = DistancesFromCloth(bent);
    EXPECT_GT(Largest(before_m), 1e-3);
    MoveCenters(OffsetsToCloth(bent.shape, bent.layout, Eigen::Vector3d::UnitZ()), &bent.shape);
    const std::vector<double> after_m = DistancesFromCloth(bent);
    EXPECT_LT(Rms(after_m), 0.2 * Rms(before_m));
    EXPECT_LT(Largest(after_m), 0.3 * Largest(before_m));
  }
}

// The chord of the uppermost line turns, because its luff bends more than its leech.
TEST(ClothPlaces, MakesTheTwistTrue) {
  std::vector<double> before_deg, after_deg;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    BentSail bent = DrawBentSail(seed);
    const auto chord = [&](std::size_t j) -> Eigen::Vector3d {
      const double v = bent.lines.vs[j];
      return bent.sail({bent.lines.last_us[j], v}) - bent.sail({bent.lines.first_us[j], v});
    };
    const std::size_t top = bent.lines.vs.size() - 1;
    const Eigen::Vector3d a = chord(0), b = chord(top);
    const double twist_deg = kDegPerRad * std::acos(a.head<2>().dot(b.head<2>()) /
                                                    (a.head<2>().norm() * b.head<2>().norm()));
    ShapeFrame frame;
    frame.up_in_frame = Eigen::Vector3d::UnitZ();
    const auto error_deg = [&] {
      const SectionReport report = ComputeSections(bent.shape, frame, bent.layout, nullptr);
      return std::abs(report.sections.back().twist_deg->value) - twist_deg;
    };
    before_deg.push_back(error_deg());
    MoveCenters(OffsetsToCloth(bent.shape, bent.layout, frame.up_in_frame), &bent.shape);
    after_deg.push_back(error_deg());
  }
  EXPECT_GT(Rms(before_deg), 0.1);
  EXPECT_LT(Rms(after_deg), 0.5 * Rms(before_deg));
}

TEST(ClothPlaces, APartWithoutASurfaceHasNone) {
  BentSail bent = DrawBentSail(1);
  bent.layout.parts[0].horizontal.resize(1);
  EXPECT_TRUE(OffsetsToCloth(bent.shape, bent.layout, Eigen::Vector3d::UnitZ()).empty());
}

}  // namespace
}  // namespace velamap
