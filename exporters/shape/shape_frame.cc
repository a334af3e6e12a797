#include "exporters/shape/shape_frame.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "exporters/shape/part_axes.h"
#include "exporters/shape/sail_lines.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

// x along `x_in_shape`; z orthogonal to it, in the plane of `x_in_shape` and `up_in_shape`.
Rigid3 FrameFromAxes(const Eigen::Vector3d& origin_in_shape, const Eigen::Vector3d& x_in_shape,
                     const Eigen::Vector3d& up_in_shape) {
  const Eigen::Vector3d x = x_in_shape.normalized();
  const Eigen::Vector3d y = up_in_shape.cross(x).normalized();
  Eigen::Matrix3d axes;
  axes << x, y, x.cross(y);
  const Eigen::Quaterniond frame_from_shape(Eigen::Matrix3d(axes.transpose()));
  return {frame_from_shape, -(frame_from_shape * origin_in_shape)};
}

std::string WhichMissing(const MarkerShape& shape, const std::vector<int>& ids) {
  std::vector<int> missing;
  for (const int id : ids) {
    if (FindWholeMarker(shape, id) == nullptr) missing.push_back(id);
  }
  if (missing.empty()) return "";
  return fmt::format("marker{} {} {} not reconstructed whole", missing.size() == 1 ? "" : "s",
                     fmt::join(missing, " "), missing.size() == 1 ? "was" : "were");
}

ShapeFrame MakeUpright(const Rigid3& frame_from_shape, const std::string& name,
                       const std::string& description) {
  ShapeFrame frame;
  frame.frame_from_shape = frame_from_shape;
  frame.name = name;
  frame.description = description;
  frame.up_in_frame = Eigen::Vector3d::UnitZ();
  return frame;
}

FrameAttempt TryMarkers(const MarkerShape& shape, const FrameChoice& choice) {
  const std::vector<int> ids = {choice.origin_id, choice.axis_id, choice.plane_id};
  const std::string missing = WhichMissing(shape, ids);
  if (!missing.empty()) return {std::nullopt, missing};
  const Eigen::Vector3d origin = CenterOf(shape, ids[0]);
  const Eigen::Vector3d x = CenterOf(shape, ids[1]) - origin;
  const Eigen::Vector3d up = CenterOf(shape, ids[2]) - origin;
  const std::string names = fmt::format("{}", fmt::join(ids, " "));
  if (!SpanPlane(x, up)) {
    return {std::nullopt, fmt::format("markers {} lie on one line to within 3 degrees", names)};
  }
  return {MakeUpright(FrameFromAxes(origin, x, up), "markers " + names,
                      fmt::format("origin at marker {}, x to marker {}, z on the side of marker {}",
                                  ids[0], ids[1], ids[2])),
          ""};
}

FrameAttempt TryReferencePart(const MarkerShape& shape, const Layout& layout) {
  if (!layout.reference_part) return {std::nullopt, "the layout names no reference_part"};
  std::vector<int> ids, missing;
  for (const int id : MarkersOfPart(layout, *layout.reference_part)) {
    (FindWholeMarker(shape, id) != nullptr ? ids : missing).push_back(id);
  }
  const std::string& part = *layout.reference_part;
  if (ids.size() < 2) {
    return {std::nullopt, fmt::format("part '{}' has {} whole marker{}; two are needed", part,
                                      ids.size(), ids.size() == 1 ? "" : "s")};
  }
  const auto axes = FitPartAxes(shape, ids);
  if (!axes) {
    return {std::nullopt, fmt::format("part '{}' has no axes: marker {} is in front of marker {}",
                                      part, ids.front(), ids.back())};
  }
  const Eigen::Vector3d up = SailUp(shape, layout).value_or(axes->marker_up);
  const Eigen::Vector3d aft = SailAft(shape, layout).value_or(axes->axes[0]);
  const int z = NearestAxis(axes->axes, up, -1);
  const int x = NearestAxis(axes->axes, aft, z);
  const auto along = [&](int axis, const Eigen::Vector3d& direction) -> Eigen::Vector3d {
    const Eigen::Vector3d& unit = axes->axes[static_cast<std::size_t>(axis)];
    return unit.dot(direction) < 0 ? Eigen::Vector3d(-unit) : unit;
  };
  const std::array<const char*, 3> names = {
      "its line from first to last marker",
      axes->is_flat ? "the normal of its plane" : "the mean direction its markers face",
      "at right angles to its line and its normal"};
  const std::string by_facing = axes->is_flat ? "" : " by its markers' facing";
  const std::string without =
      missing.empty() ? "" : fmt::format(" without {}", fmt::join(missing, " "));
  return {MakeUpright(
              FrameFromAxes(axes->center, along(x, aft), along(z, up)),
              "reference part " + part + by_facing + without,
              fmt::format("origin at the mean of the markers of '{}', x aft: {}, z up: {}", part,
                          names[static_cast<std::size_t>(x)], names[static_cast<std::size_t>(z)])),
          ""};
}

FrameAttempt TryLines(const MarkerShape& shape, const Layout& layout) {
  const LayoutPart* part = FirstPartWithLines(layout);
  if (part == nullptr) return {std::nullopt, "the layout has no horizontal lines"};
  const std::vector<const MarkerLine*> lines = LinesWithEnds(shape, part->horizontal);
  if (lines.empty()) {
    return {std::nullopt, "no horizontal line has both its luff and its leech marker"};
  }
  const MarkerLine& lowest = *lines.front();
  const LineEnds ends = EndsOf(shape, lowest);
  const Eigen::Vector3d x = ends.last - ends.first;
  const std::vector<const MarkerLine*> verticals = LinesWithEnds(shape, part->vertical);
  Eigen::Vector3d up;
  std::string up_name;
  if (!verticals.empty()) {
    const LineEnds vertical = EndsOf(shape, *verticals.front());
    up = vertical.last - vertical.first;
    up_name = verticals.front()->name;
  } else if (lines.size() > 1) {
    up = EndsOf(shape, *lines.back()).Middle() - ends.Middle();
    up_name = lines.back()->name;
  } else {
    return {std::nullopt, "there is neither a vertical line nor a second horizontal one"};
  }
  if (!SpanPlane(x, up)) {
    return {std::nullopt, fmt::format("lines {} and {} are parallel", lowest.name, up_name)};
  }
  const Rigid3 frame_from_shape = FrameFromAxes(ends.first, x, up);
  if (lines.size() > 1 && (frame_from_shape * EndsOf(shape, *lines.back()).Middle()).z() < 0) {
    return {
        std::nullopt,
        fmt::format("along line {} as up, {} is below {}; list horizontal lines and the markers "
                    "of vertical ones from foot to head",
                    up_name, lines.back()->name, lowest.name)};
  }
  return {MakeUpright(frame_from_shape, fmt::format("lines {} {}", lowest.name, up_name),
                      fmt::format("origin at marker {}, the luff of line {}, x to marker {}, its "
                                  "leech, z up {} {}",
                                  lowest.marker_ids.front(), lowest.name, lowest.marker_ids.back(),
                                  verticals.empty() ? "to" : "along", up_name)),
          ""};
}

ShapeFrame CameraFrame(const MarkerShape& shape, const Layout& layout) {
  ShapeFrame frame;
  frame.description =
      "the frame of the model, by default the central camera: x right, y down, z forward";
  frame.up_in_frame = SailUp(shape, layout);
  return frame;
}

FrameAttempt Try(FrameKind kind, const FrameChoice& choice, const MarkerShape& shape,
                 const Layout& layout, const FrameAttempt& known_points) {
  switch (kind) {
    case FrameKind::kKnownPoints:
      return known_points;
    case FrameKind::kMarkers:
      return TryMarkers(shape, choice);
    case FrameKind::kReferencePart:
      return TryReferencePart(shape, layout);
    case FrameKind::kLines:
      return TryLines(shape, layout);
    case FrameKind::kCamera:
      break;
  }
  return {CameraFrame(shape, layout), ""};
}

std::string NameOf(FrameKind kind, const FrameChoice& choice) {
  return kind == FrameKind::kMarkers
             ? fmt::format("markers {} {} {}", choice.origin_id, choice.axis_id, choice.plane_id)
             : FrameKeyword(kind);
}

[[noreturn]] void ThrowFrameNotPossible(const FrameChoice& choice, const std::string& reason) {
  throw InputError(
      fmt::format("--frame: the frame '{}' is not possible: {}; leave the option out, or "
                  "give another frame",
                  NameOf(choice.kind, choice), reason));
}

bool HasDatum(const Layout& layout) {
  return std::any_of(layout.known_points.begin(), layout.known_points.end(),
                     [](const KnownPoint& point) { return !point.is_check; });
}

std::string LeewardText(const MarkerShape& shape, const Layout& layout, const ShapeFrame& frame) {
  const Eigen::Vector3d y_in_shape =
      frame.frame_from_shape.rotation.conjugate() * Eigen::Vector3d::UnitY();
  const int side = BulgeSide(shape, layout, y_in_shape);
  if (side == 0) return ", y = z x x";
  return side > 0 ? ", y to leeward (the side to which the sail bulges)"
                  : ", y to windward (the sail bulges to -y)";
}

}  // namespace

std::string FrameText(const ShapeFrame& frame) {
  std::string text = frame.name + ": " + frame.description;
  for (const std::string& reason : frame.reasons) text += "; " + reason;
  return text;
}

void CheckFrameChoice(const std::optional<FrameChoice>& choice, const Layout& layout) {
  if (!choice) return;
  if (choice->kind == FrameKind::kKnownPoints) {
    if (layout.known_points.empty())
      ThrowFrameNotPossible(*choice, "the layout has no known_points");
    const std::string lack = WhatDatumLacks(layout.known_points);
    if (!lack.empty()) {
      ThrowFrameNotPossible(*choice, "the layout's known_points do not suffice: " + lack);
    }
  }
  if (choice->kind == FrameKind::kReferencePart && !layout.reference_part) {
    ThrowFrameNotPossible(*choice, "the layout names no reference_part");
  }
  if (choice->kind == FrameKind::kLines && FirstPartWithLines(layout) == nullptr) {
    ThrowFrameNotPossible(*choice, "the layout has no horizontal lines");
  }
  if (choice->kind != FrameKind::kMarkers || !layout.HasMarkers()) return;
  for (const int id : {choice->origin_id, choice->axis_id, choice->plane_id}) {
    const std::vector<int> known = MarkerIds(layout);
    if (!std::binary_search(known.begin(), known.end(), id)) {
      ThrowFrameNotPossible(*choice, fmt::format("the layout names no marker {}", id));
    }
  }
}

ShapeFrame ChooseFrame(const MarkerShape& shape, const Layout& layout,
                       const std::optional<FrameChoice>& choice, const FrameAttempt& known_points) {
  std::vector<FrameKind> order = {FrameKind::kReferencePart, FrameKind::kLines, FrameKind::kCamera};
  if (HasDatum(layout)) order.insert(order.begin(), FrameKind::kKnownPoints);
  const FrameChoice wanted = choice.value_or(layout.frame.value_or(FrameChoice{order.front()}));
  order.erase(std::remove(order.begin(), order.end(), wanted.kind), order.end());
  order.insert(order.begin(), wanted.kind);
  std::vector<std::string> reasons;
  for (const FrameKind kind : order) {
    FrameAttempt attempt = Try(kind, wanted, shape, layout, known_points);
    if (!attempt.frame) {
      if (choice) ThrowFrameNotPossible(wanted, attempt.reason);
      reasons.push_back(fmt::format("not by {}: {}", NameOf(kind, wanted), attempt.reason));
      continue;
    }
    // The y of a camera or of the user need not be across the sail.
    if (kind != FrameKind::kCamera && kind != FrameKind::kKnownPoints) {
      attempt.frame->description += LeewardText(shape, layout, *attempt.frame);
    }
    attempt.frame->reasons = reasons;
    return *attempt.frame;
  }
  VELAMAP_CHECK(false && "the camera's frame is always available");
  return {};
}

}  // namespace velamap
