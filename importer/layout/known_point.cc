#include "importer/layout/known_point.h"

#include <algorithm>

#include <fmt/format.h>

namespace velamap {

int KnownPoint::NumCoordinates() const {
  return static_cast<int>(
      std::count_if(x_m.begin(), x_m.end(), [](const auto& x) { return x.has_value(); }));
}

std::string PointName(int marker_id, int corner) {
  return corner == 0 ? std::to_string(marker_id) : fmt::format("{}.{}", marker_id, corner);
}

std::string WhatDatumLacks(const std::vector<KnownPoint>& points) {
  constexpr int kMinPoints = 3, kMinCoordinates = 6;
  int num_points = 0, num_coordinates = 0;
  std::array<int, 3> num_along{};
  for (const KnownPoint& point : points) {
    if (point.is_check) continue;
    ++num_points;
    num_coordinates += point.NumCoordinates();
    for (std::size_t axis = 0; axis < 3; ++axis) num_along[axis] += point.x_m[axis].has_value();
  }
  std::vector<std::string> open;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (num_along[axis] == 0) open.push_back(kAxisNames[axis]);
  }
  if (num_points == 0) return "none is given, apart from checks";
  if (open.size() == 2) {
    const std::size_t known = num_along[0] > 0 ? 0 : num_along[1] > 0 ? 1 : 2;
    return fmt::format(
        "they have {} alone, which leaves shifts along {} and {} and a turn about {} "
        "open",
        kAxisNames[known], open[0], open[1], kAxisNames[known]);
  }
  if (num_points < kMinPoints) {
    return fmt::format("{} point{} given; three are needed", num_points,
                       num_points == 1 ? " is" : "s are");
  }
  if (!open.empty()) {
    return fmt::format("none has {}, which leaves a shift along {} open", open[0], open[0]);
  }
  if (num_coordinates < kMinCoordinates) {
    return fmt::format("{} coordinates are given; six are needed", num_coordinates);
  }
  return "";
}

}  // namespace velamap
