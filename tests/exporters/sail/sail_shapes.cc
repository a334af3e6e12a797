#include "tests/exporters/sail/sail_shapes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "exporters/shape/shape_transform.h"
#include "importer/geometry/units.h"

namespace velamap {

UnitProfile CircularArc(double camber) {
  // camber = (1 - cos h) / (2 sin h) = tan(h / 2) / 2 with h half the arc's angle.
  const double half = 2 * std::atan(2 * camber);
  return [half](double fraction) -> Eigen::Vector2d {
    if (half == 0) return {fraction, 0};
    const double angle = half * (2 * fraction - 1), radius = 0.5 / std::sin(half);
    return {0.5 + radius * std::sin(angle), radius * (std::cos(angle) - std::cos(half))};
  };
}

UnitProfile NacaCamberLine(double camber, double position) {
  return [=](double x) -> Eigen::Vector2d {
    const double p = position;
    if (x < p) return {x, camber / (p * p) * (2 * p * x - x * x)};
    return {x, camber / ((1 - p) * (1 - p)) * (1 - 2 * p + 2 * p * x - x * x)};
  };
}

ShapeMarker UprightMarker(int marker_id, const std::string& part, const Eigen::Vector3d& center_m) {
  constexpr double kHalf_m = 0.05;
  ShapeMarker marker;
  marker.marker_id = marker_id;
  marker.part = part;
  const std::array<Eigen::Vector3d, 5> offsets = {
      {{0, 0, 0}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}};
  for (std::size_t corner = 0; corner < offsets.size(); ++corner) {
    marker.x_in_shape_m[corner] = center_m + kHalf_m * offsets[corner];
    marker.num_frames[corner] = 10;
  }
  return marker;
}

Sail MakeSailOfLines(const std::vector<SailLine>& lines, int num_markers, int leeward) {
  Sail sail;
  sail.layout = MakeLayout("DICT_4X4_250", 0.1);
  LayoutPart part;
  part.name = "sail";
  MarkerLine luff{"v1", {}};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const SailLine& line = lines[i];
    const double twist = leeward * line.twist_deg * kRadPerDeg;
    const Eigen::Vector3d along(std::cos(twist), std::sin(twist), 0);
    const Eigen::Vector3d out = leeward * Eigen::Vector3d(-std::sin(twist), std::cos(twist), 0);
    MarkerLine ids{fmt::format("h{}", i + 1), {}};
    for (int j = 0; j < num_markers; ++j) {
      const Eigen::Vector2d profile = line.profile(static_cast<double>(j) / (num_markers - 1));
      ids.marker_ids.push_back(static_cast<int>(100 * (i + 1)) + j);
      sail.shape.markers.push_back(
          UprightMarker(ids.marker_ids.back(), part.name,
                        Eigen::Vector3d(0, 0, line.height_m) +
                            line.chord_m * (profile.x() * along + profile.y() * out)));
    }
    luff.marker_ids.push_back(ids.marker_ids.front());
    part.horizontal.push_back(ids);
  }
  part.vertical.push_back(luff);
  sail.layout.parts.push_back(part);
  return sail;
}

Sail ExampleSail(int num_markers, int leeward) {
  return MakeSailOfLines({{0.0, 3.0, 0.0, CircularArc(0.08)},
                          {2.0, 2.4, 6.0, CircularArc(0.10)},
                          {4.0, 1.6, 14.0, CircularArc(0.12)}},
                         num_markers, leeward);
}

void AddHull(const std::vector<Eigen::Vector3d>& centers_m, Sail* sail) {
  LayoutPart hull;
  hull.name = "hull";
  hull.rigid = true;
  auto place = sail->shape.markers.begin();  // before those of the sail, by id
  for (const Eigen::Vector3d& center_m : centers_m) {
    hull.marker_ids.push_back(10 + static_cast<int>(hull.marker_ids.size()));
    place = sail->shape.markers.insert(place,
                                       UprightMarker(hull.marker_ids.back(), hull.name, center_m));
    ++place;
  }
  sail->layout.parts.push_back(hull);
  sail->layout.reference_part = hull.name;
}

MarkerShape Moved(const Rigid3& new_from_shape, const MarkerShape& shape) {
  MarkerShape moved = shape;
  for (ShapeMarker& marker : moved.markers) {
    for (auto& x : marker.x_in_shape_m) {
      if (x) x = new_from_shape * *x;
    }
  }
  return moved;
}

Rigid3 ArbitraryMotion() {
  return {Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized(), {0.4, -1.7, 2.9}};
}

void ShiftMarker(int marker_id, const Eigen::Vector3d& shift_m, MarkerShape* shape) {
  for (ShapeMarker& marker : shape->markers) {
    if (marker.marker_id != marker_id) continue;
    for (auto& x : marker.x_in_shape_m) {
      if (x) *x += shift_m;
    }
  }
}

void RemoveMarker(int marker_id, MarkerShape* shape) {
  auto& markers = shape->markers;
  markers.erase(std::remove_if(markers.begin(), markers.end(),
                               [&](const ShapeMarker& m) { return m.marker_id == marker_id; }),
                markers.end());
}

void SetSigma(double sigma_m, MarkerShape* shape) {
  for (ShapeMarker& marker : shape->markers) {
    for (auto& sigma : marker.sigma_m) sigma = Eigen::Vector3d::Constant(sigma_m);
  }
}

SectionReport SectionsOf(const Sail& sail, const SectionOptions& options,
                         const std::optional<FrameChoice>& choice) {
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout, choice);
  MarkerShape shape = sail.shape;
  MoveShape(frame.frame_from_shape, nullptr, &shape);
  return ComputeSections(shape, frame, sail.layout, nullptr, options);
}

std::vector<double> NumbersOf(const Section& section) {
  return {section.chord_m.value,
          section.camber.value,
          section.draft_position ? section.draft_position->value : -1,
          section.entry_angle_deg.value,
          section.exit_angle_deg.value,
          section.twist_deg.value().value,
          section.leech_twist_deg.value().value,
          section.girth_m.value,
          section.height_m};
}

}  // namespace velamap
