#include "importer/print/placement.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/geometry/quad.h"

namespace velamap {
namespace {

constexpr double kGap_mm = 5.0;       // between stickers, and to the sail's edges
constexpr int kMarkersOfTopLine = 4;  // the fewest markers that give a section of the sail
// The smallest squared distance of the clew from the luff, as a fraction of the squared foot. In a
// flatter triangle, a length must be wrong.
constexpr double kMinHeightOfFoot = 1e-3;

// The sail's triangle and the room that stickers need in it.
struct Sail {
  Eigen::Vector2d tack = Eigen::Vector2d::Zero(), clew, head;
  double luff_mm = 0.0, foot_mm = 0.0, leech_mm = 0.0;
  // Distances of the first centre from the luff and of the last from the leech, along the line.
  double from_luff_mm = 0.0, from_leech_mm = 0.0;
  double pitch_mm = 0.0;    // smallest distance between neighbours on a line
  double min_height = 0.0;  // of the lowest line, as a fraction of the luff

  double RoomAt(double height) const {
    return (1 - height) * foot_mm - from_luff_mm - from_leech_mm;
  }
};

double RequireLength(const std::optional<double>& length_m, const std::string& option) {
  if (!length_m) {
    throw InputError(option + ": missing; a sail needs the lengths of luff, foot and leech in m");
  }
  return 1000 * *length_m;
}

Sail MakeSail(const SailPlacementOptions& options, double sticker_mm) {
  Sail sail;
  sail.luff_mm = RequireLength(options.luff_m, OptionName(&SailPlacementOptions::luff_m));
  sail.foot_mm = RequireLength(options.foot_m, OptionName(&SailPlacementOptions::foot_m));
  sail.leech_mm = RequireLength(options.leech_m, OptionName(&SailPlacementOptions::leech_m));
  const double luff = sail.luff_mm, foot = sail.foot_mm, leech = sail.leech_mm;
  const double clew_up = (luff * luff + foot * foot - leech * leech) / (2 * luff);
  const double squared = foot * foot - clew_up * clew_up;
  if (!(squared > kMinHeightOfFoot * foot * foot)) {
    throw InputError(fmt::format(
        "{}: a sail with luff {} m, foot {} m and leech {} m is not a triangle; measure again: "
        "each side is shorter than the other two together",
        OptionName(&SailPlacementOptions::leech_m), luff / 1000, foot / 1000, leech / 1000));
  }
  sail.clew = {std::sqrt(squared), clew_up};
  sail.head = {0, luff};
  // The circle around a sticker keeps clear of the edges of the sail.
  const double clear_mm = sticker_mm / std::sqrt(2.0) + kGap_mm;
  const Eigen::Vector2d along = (sail.clew - sail.tack) / foot;
  sail.from_luff_mm = clear_mm / std::abs(Cross(along, (sail.head - sail.tack) / luff));
  sail.from_leech_mm = clear_mm / std::abs(Cross(along, (sail.head - sail.clew) / leech));
  sail.pitch_mm = sticker_mm + kGap_mm;
  sail.min_height = clear_mm / std::abs(Cross(along, sail.head - sail.tack));
  return sail;
}

// The number of markers that a line at this height has room for, at most `wanted`.
int NumMarkersAt(const Sail& sail, double height, int wanted) {
  const double room = sail.RoomAt(height);
  constexpr double kRounding_mm = 1e-6;
  if (room < -kRounding_mm) return 0;
  return std::min(wanted,
                  1 + static_cast<int>(std::floor(std::max(0.0, room) / sail.pitch_mm + 1e-9)));
}

// The heights of the horizontal lines, as fractions of the luff.
struct LineHeights {
  double first = 0.0, step = 0.0;
};

LineHeights SpaceLines(const Sail& sail, int num_lines, int markers_on_top) {
  const double max_height =
      1 - (sail.from_luff_mm + sail.from_leech_mm + (markers_on_top - 1) * sail.pitch_mm) /
              sail.foot_mm;
  const double step = num_lines > 1 ? (max_height - sail.min_height) / (num_lines - 1) : 0.0;
  const double step_mm = step * sail.luff_mm * sail.clew.x() / sail.foot_mm;  // across the lines
  if (max_height < sail.min_height || (num_lines > 1 && step_mm < sail.pitch_mm)) {
    throw InputError(fmt::format(
        "{}: the sail has no room for {} lines, the uppermost with {} stickers of {:.0f} mm; give "
        "fewer lines or smaller markers (--marker_length)",
        OptionName(&SailPlacementOptions::num_lines), num_lines, markers_on_top,
        sail.pitch_mm - kGap_mm));
  }
  return {sail.min_height, step};
}

PlacedLine MakeLine(const Sail& sail, const std::string& name, double height, int count,
                    int first_id) {
  PlacedLine line{name, {}, height * sail.luff_mm, height * sail.leech_mm};
  const Eigen::Vector2d start = sail.tack + height * (sail.head - sail.tack);
  const Eigen::Vector2d along = (sail.clew - sail.tack) / sail.foot_mm;
  for (int i = 0; i < count; ++i) {
    const double part = count > 1 ? double(i) / (count - 1) : 0.5;
    const double along_mm = sail.from_luff_mm + part * sail.RoomAt(height);
    line.markers.push_back({first_id + i, start + along_mm * along, along_mm});
  }
  return line;
}

double RoundedMetres(double length_mm) { return std::round(length_mm) / 1000; }

// The distances from the outer markers to the edges of the sail: to luff and leech along the lines,
// to foot and head across them.
ClothEdges EdgesOf(const Sail& sail, const std::vector<PlacedLine>& lines, double sticker_mm) {
  ClothEdges edges;
  for (const PlacedLine& line : lines) {
    const double length_mm = (1 - line.luff_mm / sail.luff_mm) * sail.foot_mm;
    edges.luff.offsets_m.push_back(RoundedMetres(line.markers.front().along_mm));
    edges.leech.offsets_m.push_back(RoundedMetres(length_mm - line.markers.back().along_mm));
  }
  for (ClothEdge* edge : {&edges.luff, &edges.leech}) {
    std::vector<double>& offsets_m = edge->offsets_m;
    if (std::count(offsets_m.begin(), offsets_m.end(), offsets_m.front()) ==
        static_cast<std::ptrdiff_t>(offsets_m.size())) {
      offsets_m.resize(1);
    }
  }
  const double head_mm = (1 - sticker_mm / sail.foot_mm) * sail.luff_mm;
  const Eigen::Vector2d along = (sail.clew - sail.tack) / sail.foot_mm;
  const double across = std::abs(Cross(along, (sail.head - sail.tack) / sail.luff_mm));
  edges.foot.offsets_m = {RoundedMetres(across * lines.front().luff_mm)};
  edges.head.offsets_m = {RoundedMetres(across * std::max(0.0, head_mm - lines.back().luff_mm))};
  return edges;
}

// Adds the vertical line of the markers with the index `column` on the lines from `begin` to `end`,
// if these are at least two. A negative index counts from the leech.
void AddColumn(const std::vector<PlacedLine>& lines, std::size_t begin, std::size_t end, int column,
               std::vector<MarkerLine>* vertical) {
  if (end - begin < 2) return;
  MarkerLine line{fmt::format("v{}", vertical->size() + 1), {}};
  for (std::size_t i = begin; i < end; ++i) {
    const std::vector<MarkerPlace>& markers = lines[i].markers;
    const auto idx = static_cast<std::size_t>(column < 0 ? int(markers.size()) + column : column);
    line.marker_ids.push_back(markers[idx].marker_id);
  }
  vertical->push_back(line);
}

std::vector<MarkerLine> MakeVerticalLines(const std::vector<PlacedLine>& lines) {
  std::vector<MarkerLine> vertical;
  AddColumn(lines, 0, lines.size(), 0, &vertical);
  for (std::size_t begin = 0, end = 0; begin < lines.size(); begin = end) {
    const std::size_t count = lines[begin].markers.size();
    for (end = begin; end < lines.size() && lines[end].markers.size() == count;) ++end;
    for (int column = 1; column + 1 < static_cast<int>(count); ++column) {
      AddColumn(lines, begin, end, column, &vertical);
    }
  }
  const bool has_leech = std::all_of(
      lines.begin(), lines.end(), [](const PlacedLine& line) { return line.markers.size() > 1; });
  if (has_leech) AddColumn(lines, 0, lines.size(), -1, &vertical);
  return vertical;
}

}  // namespace

OptionGroup DescribeOptions(GridPlacementOptions* options) {
  return {"Grid, board and charuco",
          {{"Grid.rows", &options->num_rows, "count", "rows of markers, or of squares of a charuco",
            FromTo(1, 200)},
           {"Grid.columns", &options->num_columns, "count",
            "columns of markers, or of squares of a charuco", FromTo(1, 200)},
           {"Grid.spacing", &options->spacing_m, "m",
            "distance between the centres of neighbours, or side of a charuco's squares; left out: "
            "2 marker sides on a grid, 1.25 on a board, 10/7 on a charuco",
            FromTo(1e-4, 100)}}};
}

void GridPlacementOptions::Check() const { CheckRanges(*this); }

OptionGroup DescribeOptions(SailPlacementOptions* options) {
  return {
      "Sail and hull",
      {Common({"Sail.luff", &options->luff_m, "m", "length of the luff, tack to head",
               FromTo(0.05, 200)}),
       Common({"Sail.foot", &options->foot_m, "m", "length of the foot, tack to clew",
               FromTo(0.05, 200)}),
       Common({"Sail.leech", &options->leech_m, "m", "length of the leech, clew to head",
               FromTo(0.05, 200)}),
       {"Sail.lines", &options->num_lines, "count", "horizontal lines of markers", FromTo(1, 200)},
       {"Sail.markers_per_line", &options->markers_per_line, "count",
        "markers on a line; fewer near the head, where they have no room", FromTo(1, 500)},
       {"hull_markers", &options->hull_markers, "count",
        "markers on the hull, a rigid part relative to which motion is measured; for a hull "
        "without a sail, 0 means 8",
        FromTo(0, 500)}}};
}

void SailPlacementOptions::Check() const { CheckRanges(*this); }

Placement PlaceOnSail(const SailPlacementOptions& options, double length_mm, double sticker_mm,
                      int first_id) {
  const Sail sail = MakeSail(options, sticker_mm);
  const LineHeights heights =
      SpaceLines(sail, options.num_lines, std::min(kMarkersOfTopLine, options.markers_per_line));
  Placement placement{"sail", length_mm, sticker_mm, {sail.tack, sail.clew, sail.head}, {}, {}, {}};
  for (int i = 0; i < options.num_lines; ++i) {
    const double height = heights.first + i * heights.step;
    const int count = NumMarkersAt(sail, height, options.markers_per_line);
    placement.horizontal.push_back(
        MakeLine(sail, fmt::format("h{}", i + 1), height, count, first_id));
    first_id += count;
  }
  placement.vertical = MakeVerticalLines(placement.horizontal);
  placement.edges = EdgesOf(sail, placement.horizontal, sticker_mm);
  return placement;
}

Placement PlaceLinesOnSail(const SailPlacementOptions& options, const Layout& layout,
                           double sticker_mm) {
  const LayoutPart* part = FirstPartWithLines(layout);
  if (part == nullptr) {
    throw InputError(
        "--layout_path: the layout has no horizontal lines to place on a sail; give lines, or "
        "leave the layout out");
  }
  const Sail sail = MakeSail(options, sticker_mm);
  const std::vector<MarkerLine>& lines = part->horizontal;
  const LineHeights heights = SpaceLines(sail, static_cast<int>(lines.size()),
                                         static_cast<int>(lines.back().marker_ids.size()));
  Placement placement{part->name, 1000 * layout.marker_length_m,
                      sticker_mm, {sail.tack, sail.clew, sail.head},
                      {},         part->vertical,
                      {}};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double height = heights.first + static_cast<double>(i) * heights.step;
    const int count = static_cast<int>(lines[i].marker_ids.size());
    if (NumMarkersAt(sail, height, count) < count) {
      throw InputError(fmt::format(
          "--layout_path: line {} has {} markers, for which a sail of these lengths has no room; "
          "check {}, {} and {}",
          lines[i].name, count, OptionName(&SailPlacementOptions::luff_m),
          OptionName(&SailPlacementOptions::foot_m), OptionName(&SailPlacementOptions::leech_m)));
    }
    PlacedLine line = MakeLine(sail, lines[i].name, height, count, 0);
    for (std::size_t k = 0; k < line.markers.size(); ++k) {
      line.markers[k].marker_id = lines[i].marker_ids[k];
    }
    placement.horizontal.push_back(line);
  }
  return placement;
}

Placement PlaceOnGrid(const GridPlacementOptions& options, double length_mm, double sticker_mm,
                      int first_id) {
  const double spacing_mm = options.spacing_m ? 1000 * *options.spacing_m : 2 * length_mm;
  if (spacing_mm < sticker_mm) {
    throw InputError(
        fmt::format("{}: stickers of {:.1f} mm overlap at {:.1f} mm; give {:.3f} m or more, or "
                    "smaller stickers",
                    OptionName(&GridPlacementOptions::spacing_m), sticker_mm, spacing_mm,
                    std::ceil(sticker_mm) / 1000));
  }
  Placement placement{"surface", length_mm, sticker_mm, {}, {}, {}, {}};
  for (int row = 0; row < options.num_rows; ++row) {
    PlacedLine line{fmt::format("h{}", row + 1), {}, 0, 0};
    for (int column = 0; column < options.num_columns; ++column) {
      line.markers.push_back(
          {first_id++, spacing_mm * Eigen::Vector2d(column, row), spacing_mm * column});
    }
    placement.horizontal.push_back(line);
  }
  placement.vertical = MakeVerticalLines(placement.horizontal);
  return placement;
}

LayoutPart PartOfPlacement(const Placement& placement) {
  LayoutPart part;
  part.name = placement.part;
  for (const PlacedLine& line : placement.horizontal) {
    MarkerLine& ids = part.horizontal.emplace_back();
    ids.name = line.name;
    for (const MarkerPlace& marker : line.markers) ids.marker_ids.push_back(marker.marker_id);
  }
  part.vertical = placement.vertical;
  part.edges = placement.edges;
  return part;
}

LayoutPart RigidPart(const std::string& name, int first_id, int num_markers) {
  LayoutPart part;
  part.name = name;
  part.rigid = true;
  part.marker_ids.resize(static_cast<std::size_t>(num_markers));
  std::iota(part.marker_ids.begin(), part.marker_ids.end(), first_id);
  return part;
}

}  // namespace velamap
