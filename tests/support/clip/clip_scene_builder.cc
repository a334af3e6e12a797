#include "tests/support/clip/clip_scene_builder.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/camera/calibration.h"
#include "tests/support/clip/clip_camera.h"
#include "tests/support/render/nine_bit_dictionary.h"

namespace velamap {
namespace {

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

ClipSheet MakeSheet(const Ground& ground, double gray, int num_columns, int num_rows) {
  ClipSheet sheet{num_columns, num_rows, {}, gray};
  for (int row = 0; row <= num_rows; ++row) {
    for (int column = 0; column <= num_columns; ++column) {
      sheet.vertices.push_back(
          VertexAt(ground, {double(column) / num_columns, 1.0 - double(row) / num_rows}));
    }
  }
  return sheet;
}

// Tiles of a sticker along one of its sides.
struct StickerGrid {
  std::vector<double> lines;  // parts of the marker's side, -0.5 to 0.5 from first to last cell
  // First and last cell that ink may reach each tile from; -1 and num_cells are the margins.
  std::vector<std::pair<int, int>> cells;

  void AddTiles(double begin, double end, int count, std::pair<int, int> reached_from) {
    for (int step = 1; step <= count; ++step) {
      lines.push_back(begin + (end - begin) * step / count);
      cells.push_back(reached_from);
    }
  }
};

StickerGrid MakeStickerGrid(int num_cells, double margin, double spread) {
  const double seam = std::abs(spread);
  const auto border = [&](int cell) {
    if (cell < 0) return -0.5 - margin;
    if (cell > num_cells) return 0.5 + margin;
    return static_cast<double>(cell) / num_cells - 0.5;
  };
  StickerGrid grid{{border(-1)}, {}};
  for (int cell = -1; cell <= num_cells; ++cell) {
    const double begin = border(cell), end = border(cell + 1);
    const double first = cell >= 0 ? begin + seam : begin;
    const double last = cell < num_cells ? end - seam : end;
    if (first > begin) grid.AddTiles(begin, first, 1, {cell - 1, cell});
    grid.AddTiles(first, last, kStepsPerCell, {cell, cell});
    if (last < end) grid.AddTiles(last, end, 1, {cell, cell + 1});
  }
  return grid;
}

// Which tiles hold ink: those that any dark cell reaches, or, where ink draws back, those that only
// dark cells reach. At the corners of cells ink spreads as a square, by less than the spread more
// than a drop would.
cv::Mat InkedTiles(const StickerGrid& grid, const cv::Mat& cells, bool draws_back) {
  const auto is_dark = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < cells.cols && y < cells.rows &&
           cells.at<std::uint8_t>(y, x) == 0;
  };
  const int num_tiles = static_cast<int>(grid.cells.size());
  cv::Mat inked(num_tiles, num_tiles, CV_8UC1);
  for (int row = 0; row < num_tiles; ++row) {
    for (int column = 0; column < num_tiles; ++column) {
      const auto [left, right] = grid.cells[static_cast<std::size_t>(column)];
      const auto [top, bottom] = grid.cells[static_cast<std::size_t>(row)];
      bool any = false, all = true;
      for (const int x : {left, right}) {
        for (const int y : {top, bottom}) {
          any = any || is_dark(x, y);
          all = all && is_dark(x, y);
        }
      }
      inked.at<std::uint8_t>(row, column) = draws_back ? all : any;
    }
  }
  return inked;
}

}  // namespace

ClipSceneBuilder::ClipSceneBuilder(const ClipOptions& options, double marker_length_m) {
  scene_.options = options;
  scene_.camera = options.camera ? ScaleToImageSize(*options.camera, options.width_px,
                                                    options.width_px * 9 / 16, "--lens")
                                 : MakeClipCamera(options.wide_angle, options.width_px);
  const int bits = options.dictionary_bits;
  scene_.dictionary =
      bits == 3 ? MakeNineBitDictionary() : LoadDictionary(fmt::format("DICT_{0}X{0}_250", bits));
  scene_.layout =
      MakeLayout(scene_.dictionary.name,
                 options.marker_length_m > 0 ? options.marker_length_m : marker_length_m);
  scene_.layout.border_bits = options.border_bits;
}

void ClipSceneBuilder::AddSheet(const Ground& ground, int num_columns, int num_rows) {
  scene_.sheets.push_back(MakeSheet(ground, GroundGray(ground), num_columns, num_rows));
}

double ClipSceneBuilder::GroundGray(const Ground& ground) const {
  const double level = scene_.options.background_level;
  return level > 0 ? 255 * level : ground.gray;
}

int ClipSceneBuilder::AddMarker(const Ground& ground, const std::string& part,
                                const Eigen::Vector2d& uv) {
  const double length_m = scene_.layout.marker_length_m;
  ClipMarker marker;
  marker.marker_id = static_cast<int>(scene_.markers.size());
  marker.part = part;
  marker.ground_gray = GroundGray(ground);
  const int num_cells = CellsPerSide(scene_.dictionary, scene_.layout.border_bits);
  marker.cells = MarkerCells(scene_.dictionary, marker.marker_id, scene_.layout.border_bits) / 255;
  const auto vertex_at = [&](double right, double up) {
    const Eigen::Vector2d offset_m = length_m * Eigen::Vector2d(right, up);
    const Eigen::Vector2d uv_before = WalkOnSurface(ground.before, uv, offset_m);
    const bool changes = scene_.options.trim_change_m > 0;
    return VertexAt(ground, uv_before,
                    changes ? WalkOnSurface(ground.after, uv, offset_m) : uv_before);
  };
  const double spread = 1e-3 * scene_.options.ink_spread_mm / length_m;
  const StickerGrid grid = MakeStickerGrid(num_cells, scene_.options.margin_sides, spread);
  marker.sheet.num_columns = marker.sheet.num_rows = static_cast<int>(grid.cells.size());
  for (const double down : grid.lines) {
    for (const double right : grid.lines) marker.sheet.vertices.push_back(vertex_at(right, -down));
  }
  marker.inked = InkedTiles(grid, marker.cells, spread < 0);
  marker.corners = {vertex_at(-0.5, 0.5), vertex_at(0.5, 0.5), vertex_at(0.5, -0.5),
                    vertex_at(-0.5, -0.5)};
  CheckRoom(ground.before(uv));
  centers_m_.push_back(ground.before(uv));
  scene_.markers.push_back(std::move(marker));
  return scene_.markers.back().marker_id;
}

double ClipSceneBuilder::StickerSize() const {
  return (1 + 2 * scene_.options.margin_sides) * scene_.layout.marker_length_m;
}

void ClipSceneBuilder::CheckRoom(const Eigen::Vector3d& center_m) const {
  for (const Eigen::Vector3d& other_m : centers_m_) {
    const double distance_m = (center_m - other_m).norm();
    if (distance_m > StickerSize()) continue;
    throw InputError(
        fmt::format("--margin_sides: {} makes stickers overlap, whose middles are {:.1f} mm apart; "
                    "give at most "
                    "{:.2f}",
                    scene_.options.margin_sides, 1e3 * distance_m,
                    std::floor(50 * (distance_m / scene_.layout.marker_length_m - 1)) / 100));
  }
}

void ClipSceneBuilder::AddPaint(const Ground& ground,
                                const std::array<Eigen::Vector2d, 4>& corners_uv,
                                double gray_change, bool alone) {
  const double sticker_m = std::sqrt(0.5) * StickerSize();
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
  paint.gray_change = gray_change * GroundGray(ground) / ground.gray;
  scene_.paint.push_back(paint);
}

}  // namespace velamap
