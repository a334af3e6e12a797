// The content of a page, independent of the file format.
//
// Page frame: x right, y down, origin at the page's top left corner, mm.

#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace velamap {

using Color = std::array<double, 3>;  // red, green, blue, 0 to 1
constexpr Color kBlack = {0, 0, 0};

// Closed outlines that are filled as one area by the nonzero winding rule: outer outlines run
// clockwise as seen on the page, and holes counterclockwise. No edge lies inside the area.
struct FilledArea {
  std::vector<std::vector<Eigen::Vector2d>> outlines_mm;
  Color color = kBlack;
};

struct Stroke {
  std::vector<Eigen::Vector2d> points_mm;
  double width_mm = 0.2;
  Color color = kBlack;
  bool is_closed = false;
  bool is_dashed = false;
};

enum class TextAnchor { kStart, kMiddle, kEnd };

constexpr double kAnyWidth = std::numeric_limits<double>::infinity();

struct Text {
  std::string text;             // UTF-8
  Eigen::Vector2d position_mm;  // start, middle or end of the baseline
  double size_mm = 3.0;         // font size; digits are 0.73 times as high
  TextAnchor anchor = TextAnchor::kStart;
  bool is_bold = false;
  Color color = kBlack;
  // The font size is reduced if the text would be wider.
  double max_width_mm = kAnyWidth;
  bool has_halo = false;  // a white outline, which keeps letters legible on top of lines
};

// Areas cover strokes, and texts cover both.
struct Drawing {
  double width_mm = 0.0;
  double height_mm = 0.0;
  std::vector<FilledArea> areas;
  std::vector<Stroke> strokes;
  std::vector<Text> texts;
};

// The outline of an axis-aligned rectangle, clockwise as seen on the page.
inline std::vector<Eigen::Vector2d> RectangleOutline(const Eigen::Vector2d& min_mm,
                                                     const Eigen::Vector2d& max_mm) {
  return {min_mm, {max_mm.x(), min_mm.y()}, max_mm, {min_mm.x(), max_mm.y()}};
}

}  // namespace velamap
