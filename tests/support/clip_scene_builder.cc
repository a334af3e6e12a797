#include "tests/support/clip_scene_builder.h"

#include <algorithm>
#include <cmath>

#include <opencv2/aruco.hpp>

#include "tests/support/clip_camera.h"
#include "tests/support/nine_bit_dictionary.h"

namespace velamap {
namespace {

constexpr double kMargin = 0.15;  // white margin of a sticker, part of the marker's side
constexpr int kStepsPerCell = 2;

ClipVertex VertexAt(const Ground& ground, const Eigen::Vector2d& uv_before,
                    const Eigen::Vector2d& uv_after) {
  ClipVertex vertex{ground.before(uv_before), ground.after(uv_after), 0.0, 0.0};
  if (ground.flaps) {
    // Zero at the luff, largest at the leech near the head; the wave runs aft.
    const double u = std::max(0.0, uv_before.x());
    vertex.flap = u * (2 - u) * (0.4 + 0.6 * uv_before.y());
    vertex.flap_phase_rad = 2.5 * u;
  }
  return vertex;
}

ClipVertex VertexAt(const Ground& ground, const Eigen::Vector2d& uv) {
  return VertexAt(ground, uv, uv);
}

ClipSheet MakeSheet(const Ground& ground, int num_columns, int num_rows) {
  ClipSheet sheet{num_columns, num_rows, {}, ground.gray};
  for (int row = 0; row <= num_rows; ++row) {
    for (int column = 0; column <= num_columns; ++column) {
      sheet.vertices.push_back(
          VertexAt(ground, {double(column) / num_columns, 1.0 - double(row) / num_rows}));
    }
  }
  return sheet;
}

// Lines of the marker's grid as parts of its side, -0.5 to 0.5 from the first cell to the last.
std::vector<double> GridLines(int num_cells) {
  std::vector<double> borders = {-0.5 - kMargin};
  for (int i = 0; i <= num_cells; ++i) borders.push_back(double(i) / num_cells - 0.5);
  borders.push_back(0.5 + kMargin);
  std::vector<double> lines = {borders.front()};
  for (std::size_t i = 1; i < borders.size(); ++i) {
    for (int step = 1; step <= kStepsPerCell; ++step) {
      lines.push_back(borders[i - 1] + (borders[i] - borders[i - 1]) * step / kStepsPerCell);
    }
  }
  return lines;
}

}  // namespace

ClipSceneBuilder::ClipSceneBuilder(const ClipOptions& options, double marker_length_m) {
  scene_.options = options;
  scene_.camera = MakeClipCamera(options.wide_angle, options.width_px);
  scene_.dictionary =
      options.dictionary_bits == 3 ? MakeNineBitDictionary() : LoadDictionary("DICT_4X4_250");
  scene_.layout = MakeLayout(scene_.dictionary.name, marker_length_m);
}

void ClipSceneBuilder::AddSheet(const Ground& ground, int num_columns, int num_rows) {
  scene_.sheets.push_back(MakeSheet(ground, num_columns, num_rows));
}

int ClipSceneBuilder::AddMarker(const Ground& ground, const std::string& part,
                                const Eigen::Vector2d& uv) {
  const double length_m = scene_.layout.marker_length_m;
  ClipMarker marker;
  marker.marker_id = static_cast<int>(scene_.markers.size());
  marker.part = part;
  marker.ground_gray = ground.gray;
  const int num_cells = scene_.dictionary.aruco->markerSize + 2 * scene_.layout.border_bits;
  cv::aruco::drawMarker(scene_.dictionary.aruco, marker.marker_id, num_cells, marker.cells,
                        scene_.layout.border_bits);
  marker.cells /= 255;
  const auto vertex_at = [&](double right, double up) {
    const Eigen::Vector2d offset_m = length_m * Eigen::Vector2d(right, up);
    const Eigen::Vector2d uv_before = WalkOnSurface(ground.before, uv, offset_m);
    const bool changes = scene_.options.trim_change_m > 0;
    return VertexAt(ground, uv_before,
                    changes ? WalkOnSurface(ground.after, uv, offset_m) : uv_before);
  };
  const std::vector<double> lines = GridLines(num_cells);
  marker.sheet.num_columns = marker.sheet.num_rows = static_cast<int>(lines.size()) - 1;
  for (const double down : lines) {
    for (const double right : lines) marker.sheet.vertices.push_back(vertex_at(right, -down));
  }
  marker.corners = {vertex_at(-0.5, 0.5), vertex_at(0.5, 0.5), vertex_at(0.5, -0.5),
                    vertex_at(-0.5, -0.5)};
  centers_m_.push_back(ground.before(uv));
  scene_.markers.push_back(std::move(marker));
  return scene_.markers.back().marker_id;
}

void ClipSceneBuilder::AddPaint(const Ground& ground,
                                const std::array<Eigen::Vector2d, 4>& corners_uv,
                                double gray_change, bool alone) {
  const double sticker_m = std::sqrt(0.5) * (1 + 2 * kMargin) * scene_.layout.marker_length_m;
  const Eigen::Vector2d middle_uv =
      0.25 * (corners_uv[0] + corners_uv[1] + corners_uv[2] + corners_uv[3]);
  const Eigen::Vector3d middle_m = ground.before(middle_uv);
  double reach_m = 0.0;
  for (const Eigen::Vector2d& uv : corners_uv) {
    reach_m = std::max(reach_m, (ground.before(uv) - middle_m).norm());
  }
  for (const Eigen::Vector3d& center_m : centers_m_) {
    if ((center_m - middle_m).norm() < sticker_m + reach_m) return;
  }
  if (alone) {
    for (const auto& [other_m, other_reach_m] : lone_paint_) {
      if ((other_m - middle_m).norm() < other_reach_m + reach_m) return;
    }
    lone_paint_.emplace_back(middle_m, reach_m);
  }
  ClipPaint paint;
  for (std::size_t i = 0; i < 4; ++i) paint.corners[i] = VertexAt(ground, corners_uv[i]);
  paint.gray_change = gray_change;
  scene_.paint.push_back(paint);
}

}  // namespace velamap
