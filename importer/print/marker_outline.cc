#include "importer/print/marker_outline.h"

#include <algorithm>
#include <map>
#include <utility>

#include "importer/base/error.h"

namespace velamap {
namespace {

using GridPoint = std::pair<int, int>;  // x, y
enum Direction { kRight, kDown, kLeft, kUp };
constexpr int kStepX[] = {1, 0, -1, 0}, kStepY[] = {0, 1, 0, -1};

// Directions of the cell sides that start at a point. The dark cell is on their right.
using Sides = std::map<GridPoint, std::vector<Direction>>;

Sides FindSides(const cv::Mat& cells) {
  const auto is_dark = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < cells.cols && y < cells.rows &&
           cells.at<std::uint8_t>(y, x) == 0;
  };
  Sides sides;
  for (int y = 0; y < cells.rows; ++y) {
    for (int x = 0; x < cells.cols; ++x) {
      if (!is_dark(x, y)) continue;
      if (!is_dark(x, y - 1)) sides[{x, y}].push_back(kRight);
      if (!is_dark(x + 1, y)) sides[{x + 1, y}].push_back(kDown);
      if (!is_dark(x, y + 1)) sides[{x + 1, y + 1}].push_back(kLeft);
      if (!is_dark(x - 1, y)) sides[{x, y + 1}].push_back(kUp);
    }
  }
  return sides;
}

// Removes and returns the side that continues one with the direction `from`. If two cells touch
// only at a corner, two sides start. The right turn then stays with the same cell.
Direction TakeNext(const GridPoint& point, Direction from, Sides* sides) {
  const auto it = sides->find(point);
  VELAMAP_CHECK(it != sides->end() && !it->second.empty());
  std::vector<Direction>& candidates = it->second;
  const auto right_turn = static_cast<Direction>((from + 1) % 4);
  auto chosen = std::find(candidates.begin(), candidates.end(), right_turn);
  if (chosen == candidates.end()) chosen = candidates.begin();
  const Direction next = *chosen;
  candidates.erase(chosen);
  if (candidates.empty()) sides->erase(it);
  return next;
}

// Follows one outline and removes its sides.
std::vector<Eigen::Vector2d> TakeOutline(Sides* sides) {
  const GridPoint start = sides->begin()->first;
  const Direction first = sides->begin()->second.front();
  std::vector<Eigen::Vector2d> corners;
  GridPoint point = start;
  Direction direction = TakeNext(start, static_cast<Direction>((first + 3) % 4), sides);
  while (true) {
    corners.emplace_back(point.first, point.second);
    // Sides in the same direction form one edge.
    Direction next = direction;
    do {
      point = {point.first + kStepX[direction], point.second + kStepY[direction]};
      if (point == start) return corners;
      next = TakeNext(point, direction, sides);
    } while (next == direction);
    direction = next;
  }
}

}  // namespace

std::vector<std::vector<Eigen::Vector2d>> OutlineDarkCells(const cv::Mat& cells) {
  VELAMAP_CHECK(cells.type() == CV_8UC1);
  std::vector<std::vector<Eigen::Vector2d>> outlines;
  for (Sides sides = FindSides(cells); !sides.empty();) outlines.push_back(TakeOutline(&sides));
  return outlines;
}

}  // namespace velamap
