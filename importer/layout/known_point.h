// Points of markers whose coordinates the user measured in a frame of their own, by hand or with a
// total station. They are the datum of the result, or checks of it.

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace velamap {

constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"};

struct KnownPoint {
  int marker_id = 0, corner = 0;             // corner 0 is the centre
  std::array<std::optional<double>, 3> x_m;  // in the user's frame; a levelled height has only z
  double sigma_m = 0.0;                      // of each coordinate
  bool is_check = false;  // only compared with the result; otherwise it is part of the datum

  int NumCoordinates() const;
};

// As in the layout file: "12" for the centre of marker 12, "12.3" for its corner 3.
std::string PointName(int marker_id, int corner);

// Why these points cannot fix a frame wherever they are: too few points or coordinates, or an axis
// along which no coordinate is given. Empty if there is no such reason. Checks do not count.
std::string WhatDatumLacks(const std::vector<KnownPoint>& points);

}  // namespace velamap
