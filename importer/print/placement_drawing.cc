#include "importer/print/placement_drawing.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

namespace velamap {
namespace {

constexpr Color kInk = {0.12, 0.12, 0.12}, kGray = {0.45, 0.45, 0.45};
constexpr Color kSail = {0.10, 0.30, 0.55}, kHorizontal = {0.55, 0.70, 0.88},
                kVertical = {0.80, 0.62, 0.45}, kVerticalName = {0.62, 0.38, 0.15};
constexpr double kBorder_mm = 12.0;
constexpr double kTitle_mm = 5.0, kWords_mm = 3.2, kRow_mm = 5.0;
constexpr double kCell_mm = 21.0;  // width of a table cell such as "123: 12.345"

// Fills a page with lines of text from the top down.
struct PageWriter {
  Drawing page;
  double y_mm = kBorder_mm;

  explicit PageWriter(const Paper& paper) {
    // Drawings are not in true scale and need at least A5, even if the markers are printed on
    // smaller paper.
    page.width_mm = std::max(148.0, std::min(paper.width_mm, paper.height_mm));
    page.height_mm = std::max(210.0, std::max(paper.width_mm, paper.height_mm));
  }
  double Width() const { return page.width_mm - 2 * kBorder_mm; }
  double Bottom() const { return page.height_mm - kBorder_mm; }
  void Write(const std::string& text, double size_mm, bool is_bold, double indent_mm = 0.0) {
    y_mm += 1.4 * size_mm;
    page.texts.push_back({text,
                          {kBorder_mm + indent_mm, y_mm},
                          size_mm,
                          TextAnchor::kStart,
                          is_bold,
                          kInk,
                          Width() - indent_mm});
  }
};

// Maps the surface (x right, y up, mm) onto the page.
struct PictureMap {
  double scale = 1.0;
  Eigen::Vector2d origin_mm = Eigen::Vector2d::Zero();

  Eigen::Vector2d operator()(const Eigen::Vector2d& surface_mm) const {
    return origin_mm + scale * Eigen::Vector2d(surface_mm.x(), -surface_mm.y());
  }
};

PictureMap FitInto(const Eigen::AlignedBox2d& free_mm, const Placement& placement) {
  Eigen::AlignedBox2d surface_mm;
  for (const Eigen::Vector2d& corner : placement.sail_mm) surface_mm.extend(corner);
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(0.5 * placement.sticker_mm);
  for (const PlacedLine& line : placement.horizontal) {
    for (const MarkerPlace& marker : line.markers) {
      surface_mm.extend(marker.center_mm - reach).extend(marker.center_mm + reach);
    }
  }
  PictureMap map;
  map.scale = (free_mm.sizes().array() / surface_mm.sizes().array()).minCoeff();
  map.origin_mm = free_mm.center() - map(surface_mm.center());
  return map;
}

// The smallest distance between neighbouring markers, mm, which limits the font size.
double LeastDistance(const Placement& placement) {
  double least = 1e30;
  const MarkerPlace* first_below = nullptr;
  for (const PlacedLine& line : placement.horizontal) {
    for (std::size_t i = 1; i < line.markers.size(); ++i) {
      least = std::min(least, (line.markers[i].center_mm - line.markers[i - 1].center_mm).norm());
    }
    const MarkerPlace& first = line.markers.front();
    if (first_below != nullptr)
      least = std::min(least, (first.center_mm - first_below->center_mm).norm());
    first_below = &first;
  }
  return std::min(least, 4 * placement.sticker_mm);
}

// The foot of the sail on the page, as a height over x.
struct Foot {
  Eigen::Vector2d tack, clew;

  double Slope() const { return (clew.y() - tack.y()) / (clew.x() - tack.x()); }
  double At(double x_mm) const { return tack.y() + Slope() * (x_mm - tack.x()); }
};

constexpr double kEdge_mm = 0.5;  // width of the sail's outline

// Moves a text that the foot would strike through below it, where nothing is behind it.
void MoveOffFoot(const Foot& foot, Text* text) {
  constexpr double kLetter = 0.66, kAscent = 0.76, kDescent = 0.24;  // of the font size
  constexpr double kFromEdge_mm = 0.4;
  const double half_width_mm =
      0.5 * kLetter * text->size_mm * static_cast<double>(text->text.size());
  const double x_mm = text->position_mm.x();
  const auto [highest_mm, lowest_mm] =
      std::minmax({foot.At(x_mm - half_width_mm), foot.At(x_mm + half_width_mm)});
  const double from_edge_mm = 0.5 * kEdge_mm + kFromEdge_mm;
  double& baseline_mm = text->position_mm.y();
  if (baseline_mm + kDescent * text->size_mm + from_edge_mm <= highest_mm) return;
  baseline_mm = lowest_mm + from_edge_mm + kAscent * text->size_mm;
  text->has_halo = false;  // it would nibble at the foot
}

void DrawSailEdges(const Placement& placement, const PictureMap& map, Drawing* page) {
  if (placement.sail_mm.empty()) return;
  const Eigen::Vector2d tack = map(placement.sail_mm[0]), clew = map(placement.sail_mm[1]),
                        head = map(placement.sail_mm[2]);
  page->strokes.push_back({{tack, clew, head}, kEdge_mm, kSail, true});
  const auto write = [&](const std::string& text, const Eigen::Vector2d& place, TextAnchor anchor) {
    page->texts.push_back({text, place, kWords_mm, anchor, false, kSail});
  };
  const auto metres = [&](std::size_t from, std::size_t to) {
    return (placement.sail_mm[from] - placement.sail_mm[to]).norm() / 1000;
  };
  // Beside the names of the outer vertical lines, and the length of the foot below all names.
  write("tack", tack + Eigen::Vector2d(1.0, 4.2), TextAnchor::kEnd);
  write("clew", clew + Eigen::Vector2d(-1.0, 4.2), TextAnchor::kStart);
  write("head", head + Eigen::Vector2d(0, -2.0), TextAnchor::kMiddle);
  constexpr double kHalfWidth_mm = 11.0;
  const double below_mm = 9.0 + kHalfWidth_mm * std::abs(Foot{tack, clew}.Slope());
  write(fmt::format("foot {:.3f} m", metres(0, 1)),
        0.5 * (tack + clew) + Eigen::Vector2d(0, below_mm), TextAnchor::kMiddle);
  write(fmt::format("leech {:.3f} m", metres(1, 2)),
        0.62 * head + 0.38 * clew + Eigen::Vector2d(3.0, -3.0), TextAnchor::kStart);
  write(fmt::format("luff {:.3f} m", metres(0, 2)), head + Eigen::Vector2d(6.0, 1.0),
        TextAnchor::kStart);
}

// Half the side of a marker in the picture.
double HalfSquare(const Placement& placement, const PictureMap& map) {
  return 0.5 * std::max(1.0, map.scale * placement.length_mm);
}

void DrawLines(const Placement& placement, const PictureMap& map, double type_mm, Drawing* page) {
  std::map<int, Eigen::Vector2d> places;  // on the page, by marker id
  for (const PlacedLine& line : placement.horizontal) {
    for (const MarkerPlace& marker : line.markers) places[marker.marker_id] = map(marker.center_mm);
  }
  const double half = HalfSquare(placement, map);
  for (const MarkerLine& line : placement.vertical) {
    Stroke stroke{{}, 0.25, kVertical};
    for (const int id : line.marker_ids) stroke.points_mm.push_back(places.at(id));
    page->strokes.push_back(stroke);
    page->texts.push_back(
        {line.name, stroke.points_mm.front() + Eigen::Vector2d(0, half + 2.0 * type_mm),
         0.85 * type_mm, TextAnchor::kMiddle, false, kVerticalName, kAnyWidth, true});
    if (!placement.sail_mm.empty()) {
      MoveOffFoot({map(placement.sail_mm[0]), map(placement.sail_mm[1])}, &page->texts.back());
    }
  }
  for (const PlacedLine& line : placement.horizontal) {
    Stroke stroke{{}, 0.3, kHorizontal};
    if (!placement.sail_mm.empty()) stroke.points_mm.push_back(map({0, line.luff_mm}));
    for (const MarkerPlace& marker : line.markers) {
      stroke.points_mm.push_back(places.at(marker.marker_id));
    }
    if (!placement.sail_mm.empty()) {
      const Eigen::Vector2d clew = placement.sail_mm[1], head = placement.sail_mm[2];
      stroke.points_mm.push_back(map(clew + line.leech_mm * (head - clew).normalized()));
    }
    page->strokes.push_back(stroke);
    const double beside =
        placement.sail_mm.empty() ? 2.0 + 0.5 * map.scale * placement.length_mm : 2.0;
    page->texts.push_back({line.name, stroke.points_mm.front() + Eigen::Vector2d(-beside, 1.1),
                           kWords_mm, TextAnchor::kEnd, true, kSail});
  }
}

void DrawMarkers(const Placement& placement, const PictureMap& map, double type_mm, Drawing* page) {
  const double half = HalfSquare(placement, map);
  for (const PlacedLine& line : placement.horizontal) {
    for (const MarkerPlace& marker : line.markers) {
      const Eigen::Vector2d place = map(marker.center_mm);
      const Eigen::Vector2d reach = Eigen::Vector2d::Constant(half);
      page->areas.push_back({{RectangleOutline(place - reach, place + reach)}, kInk});
      page->texts.push_back({fmt::format("{}", marker.marker_id),
                             place + Eigen::Vector2d(0, -half - 0.25 * type_mm), type_mm,
                             TextAnchor::kMiddle, true, kInk, kAnyWidth, true});
      page->texts.push_back({fmt::format("{:.3f}", marker.along_mm / 1000),
                             place + Eigen::Vector2d(0, half + 0.95 * type_mm), 0.85 * type_mm,
                             TextAnchor::kMiddle, false, kGray, kAnyWidth, true});
    }
  }
}

std::vector<std::string> Instructions(const Placement& placement) {
  if (placement.sail_mm.empty()) {
    return {
        "Numbers above the squares are ids, those below distances in m along the line from its "
        "first marker.",
        "The places need not be exact: the order on the lines is what counts. Arrows point up."};
  }
  return {
      "Mark where a line meets luff (from the tack) and leech (from the clew): next page. "
      "Stretch a string between the marks.",
      "Numbers above the squares are ids, those below distances in m along the string, from the "
      "luff to the marker's centre.",
      "The places need not be exact to centimetres: the order on the lines is what counts. Arrows "
      "point to the head.",
      "The luff is drawn on the left. On the other side of the sail it is on the right: mirror the "
      "places, not the markers;",
      "lines still begin at the luff."};
}

// Writes the ids of a rigid part and where its markers may go.
void WriteRigidPart(const LayoutPart& part, PageWriter* pen) {
  pen->y_mm += 2.0;
  pen->Write(fmt::format("{}: markers {}", part.name, fmt::join(part.marker_ids, " ")), kWords_mm,
             true);
  pen->Write(
      "Anywhere on what is rigid and seen together with the rest: far apart, not all on one line, "
      "at different heights.",
      kWords_mm, false);
  pen->Write("Put none on parts that move relative to it, such as the boom.", kWords_mm, false);
}

Drawing DrawPicture(const PlacementPlan& plan, const Paper& paper) {
  PageWriter pen(paper);
  pen.Write("Where the markers go", kTitle_mm, true);
  if (plan.placement) {
    const Placement& placement = *plan.placement;
    pen.Write("This drawing is not in true scale; the sheets after it are.", kWords_mm, false);
    const std::vector<std::string> instructions = Instructions(placement);
    const double below_mm = 1.4 * kWords_mm * double(instructions.size()) +
                            (plan.hull ? 4.4 * kWords_mm + 2.0 : 0.0) + 18.0;
    const Eigen::AlignedBox2d free_mm(
        Eigen::Vector2d(kBorder_mm + 8.0, pen.y_mm + 9.0),
        Eigen::Vector2d(pen.page.width_mm - kBorder_mm, pen.Bottom() - below_mm));
    const PictureMap map = FitInto(free_mm, placement);
    const double type_mm = std::clamp(0.32 * map.scale * LeastDistance(placement), 0.8, 3.0);
    DrawSailEdges(placement, map, &pen.page);
    DrawLines(placement, map, type_mm, &pen.page);
    DrawMarkers(placement, map, type_mm, &pen.page);
    pen.y_mm = free_mm.max().y() + 14.0;
    for (const std::string& line : instructions) pen.Write(line, kWords_mm, false);
  }
  if (plan.hull) WriteRigidPart(*plan.hull, &pen);
  return pen.page;
}

struct TableRow {
  std::vector<std::string> cells;
  bool is_heading = false;
};

void AddTableOfLine(const PlacedLine& line, bool is_sail, std::size_t num_columns,
                    std::vector<TableRow>* rows) {
  rows->push_back({{is_sail ? fmt::format("{}    luff: {:.3f} m from the tack    leech: {:.3f} m "
                                          "from the clew    {} markers",
                                          line.name, line.luff_mm / 1000, line.leech_mm / 1000,
                                          line.markers.size())
                            : fmt::format("{}    {} markers", line.name, line.markers.size())},
                   true});
  for (std::size_t i = 0; i < line.markers.size(); ++i) {
    if (i % num_columns == 0) rows->push_back({});
    rows->back().cells.push_back(
        fmt::format("{}: {:.3f}", line.markers[i].marker_id, line.markers[i].along_mm / 1000));
  }
}

void WriteRow(const TableRow& row, PageWriter* pen) {
  if (row.is_heading) {
    pen->y_mm += 2.0;
    pen->Write(row.cells.front(), kWords_mm, true);
    return;
  }
  pen->y_mm += kRow_mm;
  for (std::size_t i = 0; i < row.cells.size(); ++i) {
    pen->page.texts.push_back(
        {row.cells[i], {kBorder_mm + 4.0 + kCell_mm * double(i), pen->y_mm}, kWords_mm});
  }
}

std::vector<Drawing> DrawTable(const Placement& placement, const Paper& paper) {
  std::vector<Drawing> pages;
  const auto start_page = [&] {
    PageWriter pen(paper);
    pen.Write(placement.sail_mm.empty()
                  ? "Marker: distance of its centre from the line's first marker, m"
                  : "Marker: distance of its centre from the luff along the line, m",
              kTitle_mm, true);
    return pen;
  };
  PageWriter pen = start_page();
  const auto num_columns =
      std::max<std::size_t>(1, static_cast<std::size_t>((pen.Width() - 4.0) / kCell_mm));
  std::vector<TableRow> rows;
  for (const PlacedLine& line : placement.horizontal) {
    AddTableOfLine(line, !placement.sail_mm.empty(), num_columns, &rows);
  }
  rows.push_back({{"Vertical lines, from below"}, true});
  for (const MarkerLine& line : placement.vertical) {
    rows.push_back({{fmt::format("{}    {}", line.name, fmt::join(line.marker_ids, " "))}});
  }
  for (const TableRow& row : rows) {
    // A heading must not be the last line of a page.
    if (pen.y_mm + (row.is_heading ? 3 : 1) * kRow_mm > pen.Bottom()) {
      pages.push_back(pen.page);
      pen = start_page();
    }
    WriteRow(row, &pen);
  }
  pages.push_back(pen.page);
  return pages;
}

}  // namespace

std::vector<Drawing> DrawPlacement(const PlacementPlan& plan, const Paper& paper) {
  std::vector<Drawing> pages = {DrawPicture(plan, paper)};
  if (!plan.placement) return pages;
  const std::vector<Drawing> table = DrawTable(*plan.placement, paper);
  pages.insert(pages.end(), table.begin(), table.end());
  return pages;
}

}  // namespace velamap
