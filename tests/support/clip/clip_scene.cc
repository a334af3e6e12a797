#include "tests/support/clip/clip_scene.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "tests/support/clip/clip_camera.h"
#include "tests/support/clip/clip_scene_builder.h"
#include "tests/support/tool_options.h"

namespace velamap {
namespace {

// Places on the line v = constant, evenly spaced in length, `margin_m` from its ends.
std::vector<Eigen::Vector2d> SpacedAlongLine(const Surface& surface, double v, double spacing_m,
                                             double margin_m) {
  constexpr int kNumSteps = 1000;
  std::vector<double> length_m = {0.0};
  for (int i = 1; i <= kNumSteps; ++i) {
    length_m.push_back(
        length_m.back() +
        (surface({double(i) / kNumSteps, v}) - surface({double(i - 1) / kNumSteps, v})).norm());
  }
  const double usable_m = length_m.back() - 2 * margin_m;
  const int num_gaps = static_cast<int>(std::lround(usable_m / spacing_m));
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i <= num_gaps; ++i) {
    const double wanted_m = margin_m + (num_gaps > 0 ? usable_m * i / num_gaps : 0.5 * usable_m);
    const auto after = std::lower_bound(length_m.begin() + 1, length_m.end() - 1, wanted_m);
    const double step = (wanted_m - *(after - 1)) / (*after - *(after - 1));
    places.emplace_back((static_cast<double>(after - length_m.begin()) - 1 + step) / kNumSteps, v);
  }
  return places;
}

// Seven horizontal lines, and a vertical line through the marker of each that is nearest to
// mid-chord.
void AddSailMarkers(const Ground& sail, double luff_m, ClipSceneBuilder* builder) {
  constexpr int kNumLines = 7;
  // For markers of up to 100 mm; larger ones need more room.
  const double factor = std::max(1.0, builder->scene().layout.marker_length_m / 0.1);
  const double spacing_m = 0.1485 * factor, vertical_spacing_m = 0.156 * factor;
  const double margin_m = 0.11 * factor;
  LayoutPart part{"sail", false, {}, {{"v1", {}}}, {}};
  std::vector<Eigen::Vector2d> crossings;
  std::vector<int> crossing_ids;
  for (int line_idx = 0; line_idx < kNumLines; ++line_idx) {
    MarkerLine line{fmt::format("h{}", line_idx + 1), {}};
    const double v = 0.05 + 0.135 * line_idx;
    Eigen::Vector2d crossing(10, v);
    int crossing_id = -1;
    for (const Eigen::Vector2d& uv : SpacedAlongLine(sail.before, v, spacing_m, margin_m)) {
      line.marker_ids.push_back(builder->AddMarker(sail, "sail", uv));
      if (std::abs(uv.x() - 0.45) < std::abs(crossing.x() - 0.45)) {
        crossing = uv;
        crossing_id = line.marker_ids.back();
      }
    }
    crossings.push_back(crossing);
    crossing_ids.push_back(crossing_id);
    part.horizontal.push_back(line);
  }
  std::vector<int>& vertical = part.vertical.front().marker_ids;
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    vertical.push_back(crossing_ids[i]);
    if (i + 1 == crossings.size()) break;
    const double gap_m = luff_m * (crossings[i + 1].y() - crossings[i].y());
    const int num_gaps = static_cast<int>(std::lround(gap_m / vertical_spacing_m));
    for (int gap = 1; gap < num_gaps; ++gap) {
      const double t = static_cast<double>(gap) / num_gaps;
      vertical.push_back(
          builder->AddMarker(sail, "sail", (1 - t) * crossings[i] + t * crossings[i + 1]));
    }
  }
  builder->scene().layout.parts.push_back(part);
}

void AddSeams(const Ground& sail, double luff_m, ClipSceneBuilder* builder) {
  constexpr int kNumPieces = 60;
  const double half_width = 0.006 / luff_m;
  for (double v = 0.1175; v < 0.95; v += 0.135) {
    for (int i = 0; i < kNumPieces; ++i) {
      const double left = double(i) / kNumPieces, right = double(i + 1) / kNumPieces;
      builder->AddPaint(sail,
                        {{{left, v + half_width},
                          {right, v + half_width},
                          {right, v - half_width},
                          {left, v - half_width}}},
                        -22, false);
    }
  }
}

// Dark and light quads wherever there is room.
void AddClutter(const Ground& ground, double width_m, double height_m, ClipSceneBuilder* builder) {
  std::mt19937 random(builder->scene().options.seed + 17);
  const auto between = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  for (int i = 0; i < 1500; ++i) {
    const Eigen::Vector2d middle(between(0.03, 0.97), between(0.03, 0.97));
    const double half_u = between(0.008, 0.05) / width_m, half_v = between(0.008, 0.05) / height_m;
    const double skew = between(-0.5, 0.5);
    const auto corner = [&](double right, double up) {
      return Eigen::Vector2d(middle + Eigen::Vector2d(half_u * (right + skew * up), half_v * up));
    };
    builder->AddPaint(ground, {{corner(-1, 1), corner(1, 1), corner(1, -1), corner(-1, -1)}},
                      between(-140, -20), true);
  }
}

ClipScene MakeSailScene(const ClipOptions& options) {
  const double luff_m = 6.0 * options.sail_scale;
  Mainsail before{options.sail_scale, 0.10, 15 * kPi / 180};
  Mainsail after = before;
  // chord * v is at most 0.92 m on a sail of 3 m foot; there the leech moves most.
  after.twist_rad += options.trim_change_m / (0.92 * options.sail_scale);
  after.camber *= std::max(0.3, 1 - options.trim_change_m);
  const Ground sail{MakeSail(before), MakeSail(after), true, 196};
  const Surface hull_surface = [&](const Eigen::Vector2d& uv) {
    return Eigen::Vector3d(
        options.sail_scale * (-0.8 + 4.2 * uv.x()),
        options.sail_scale * (-0.15 - 1.4 * uv.x() * (1 - uv.x())) - 0.05 * uv.y(),
        0.22 + 0.32 * uv.y());
  };
  const Ground hull{hull_surface, hull_surface, false, 165};
  ClipSceneBuilder builder(options, 0.1);
  builder.AddSheet(hull, 80, 4);
  builder.AddSheet(sail, 110, 200);
  AddSailMarkers(sail, luff_m, &builder);
  LayoutPart hull_part{"hull", true, {}, {}, {}};
  for (int i = 0; i < 8; ++i) {
    hull_part.marker_ids.push_back(builder.AddMarker(hull, "hull", {0.08 + 0.12 * i, 0.5}));
  }
  AddSeams(sail, luff_m, &builder);
  if (options.busy) AddClutter(sail, 0.6 * luff_m / 2, luff_m, &builder);
  ClipScene& scene = builder.scene();
  scene.layout.parts.push_back(hull_part);
  scene.layout.reference_part = "hull";
  const double camera_height_m = 2.2 * options.sail_scale;
  const double look_up_m = options.distance_m * std::tan(9 * kPi / 180);
  scene.cam_from_world = MakeOrbit(
      options, {1.3 * options.sail_scale, -0.2, camera_height_m + look_up_m}, camera_height_m, 18);
  return std::move(scene);
}

// Rows h1 ... from the foot up and columns v1 ... on a plane; the markers stand on both.
void AddGrid(const Ground& ground, const std::string& name, int num_columns, int num_rows,
             const Eigen::Vector2d& margin_uv, ClipSceneBuilder* builder) {
  LayoutPart part{name, true, {}, {}, {}};
  for (int column = 0; column < num_columns; ++column) {
    part.vertical.push_back({fmt::format("v{}", column + 1), {}});
  }
  for (int row = 0; row < num_rows; ++row) {
    part.horizontal.push_back({fmt::format("h{}", row + 1), {}});
    for (int column = 0; column < num_columns; ++column) {
      const Eigen::Array2d place(double(column) / (num_columns - 1), double(row) / (num_rows - 1));
      const Eigen::Vector2d uv = margin_uv.array() + (1 - 2 * margin_uv.array()) * place;
      const int id = builder->AddMarker(ground, name, uv);
      part.horizontal.back().marker_ids.push_back(id);
      part.vertical[static_cast<std::size_t>(column)].marker_ids.push_back(id);
    }
  }
  builder->scene().layout.parts.push_back(part);
}

ClipScene MakeBoardScene(const ClipOptions& options) {
  // 4 x 3 markers, 70 mm from centre to centre.
  const double width_m = 0.29, height_m = 0.22;
  const Surface plane = [=](const Eigen::Vector2d& uv) {
    return Eigen::Vector3d(width_m * (uv.x() - 0.5), 0, height_m * (uv.y() - 0.5));
  };
  const Ground board{plane, plane, false, 215};
  ClipSceneBuilder builder(options, 0.04);
  builder.AddSheet(board, 8, 6);
  AddGrid(board, "board", 4, 3, {0.04 / width_m, 0.04 / height_m}, &builder);
  builder.scene().cam_from_world = MakeBoardMotion(options);
  return std::move(builder.scene());
}

ClipScene MakeWallsScene(const ClipOptions& options) {
  const double width_m = 2.0, height_m = 2.4, slant = std::sqrt(0.5) * width_m;
  ClipSceneBuilder builder(options, 0.1);
  for (const bool left : {true, false}) {
    const Surface plane = [=](const Eigen::Vector2d& uv) {
      const double from_corner = left ? uv.x() - 1 : uv.x();
      return Eigen::Vector3d(slant * from_corner, left ? slant * from_corner : -slant * from_corner,
                             height_m * uv.y());
    };
    const Ground wall{plane, plane, false, 190};
    builder.AddSheet(wall, 20, 24);
    AddGrid(wall, left ? "left_wall" : "right_wall", 4, 5, {0.12, 0.12}, &builder);
    if (options.busy) AddClutter(wall, width_m, height_m, &builder);
  }
  builder.scene().cam_from_world = MakeOrbit(options, {0, -0.5, 1.2}, 1.3, 22);
  return std::move(builder.scene());
}

void CheckOptions(const ClipOptions& options) {
  CheckOptionRange("dictionary_bits", options.dictionary_bits, 3, 5);
  CheckOptionRange("border_bits", options.border_bits, 1, 3);
  CheckOptionRange("marker_length", options.marker_length_m, 0, 1);
  CheckOptionRange("width", options.width_px, 320, 7680);
  if (options.width_px % 32 != 0) {
    throw InputError(
        fmt::format("--width: {} is not a multiple of 32, which 16:9 and the video need; "
                    "give 1280, 1920 or 3840",
                    options.width_px));
  }
  CheckOptionRange("num_frames", options.num_frames, 1, 100000);
  CheckOptionRange("fps", options.fps, 0.1, 1000);
  CheckOptionRange("distance", options.distance_m, 0.1, 100);
  CheckOptionRange("angle_deg", options.angle_deg, -80, 80);
  CheckOptionRange("drift_deg", options.drift_deg, 0, 80);
  CheckOptionRange("motion", options.motion, 'a', 'h');
  CheckOptionRange("sail_scale", options.sail_scale, 0.4, 1);
  CheckOptionRange("sail_motion_m", options.sail_motion_m, 0, 1);
  CheckOptionRange("trim_change_m", options.trim_change_m, 0, 1);
  CheckOptionRange("shake_deg", options.shake_deg, 0, 5);
  CheckOptionRange("rolling_shutter_s", options.rolling_shutter_s, -0.1, 0.1);
  CheckOptionRange("margin_sides", options.margin_sides, 0.02, 0.5);
  CheckOptionRange("ink_spread_mm", options.ink_spread_mm, -0.5, 0.5);
  CheckOptionRange("background_level", options.background_level, 0, 1);
}

// 0 before the change of trim, 1 after it; it takes a tenth of the clip.
double TrimAfter(const ClipOptions& options, double frame) {
  const double part = (frame + 0.5) / options.num_frames;
  const double t = std::clamp((part - 0.45) / 0.1, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

ClipScene MakeClipScene(const ClipOptions& options) {
  CheckOptions(options);
  switch (options.kind) {
    case ClipKind::kSail:
      return MakeSailScene(options);
    case ClipKind::kBoard:
      return MakeBoardScene(options);
    case ClipKind::kWalls:
      return MakeWallsScene(options);
  }
  throw std::logic_error("unknown kind of clip");
}

Eigen::Vector3d PositionInFrame(const ClipScene& scene, const ClipVertex& vertex, double frame) {
  const ClipOptions& options = scene.options;
  const double after = options.trim_change_m > 0 ? TrimAfter(options, frame) : 0.0;
  Eigen::Vector3d x_m = (1 - after) * vertex.x_before_m + after * vertex.x_after_m;
  if (options.sail_motion_m > 0) {
    constexpr double kPeriod_s = 2.4;
    const double periods = std::max(1.0, std::round(options.num_frames / options.fps / kPeriod_s));
    const double phase = 2 * kPi * periods * frame / options.num_frames;
    x_m.y() -= options.sail_motion_m * vertex.flap * std::sin(phase - vertex.flap_phase_rad);
  }
  return x_m;
}

MarkerShape TrueShape(const ClipScene& scene, bool after) {
  MarkerShape shape;
  for (const ClipMarker& marker : scene.markers) {
    ShapeMarker true_marker;
    true_marker.marker_id = marker.marker_id;
    true_marker.part = marker.part;
    true_marker.num_frames.fill(scene.options.num_frames);
    Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < marker.corners.size(); ++i) {
      const ClipVertex& corner = marker.corners[i];
      true_marker.x_in_shape_m[i + 1] = after ? corner.x_after_m : corner.x_before_m;
      sum_m += *true_marker.x_in_shape_m[i + 1];
    }
    true_marker.x_in_shape_m[0] = sum_m / kNumCorners;
    shape.markers.push_back(true_marker);
  }
  return shape;
}

}  // namespace velamap
