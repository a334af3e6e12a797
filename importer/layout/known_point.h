// Marker points whose coordinates were measured in a frame of the user's own, by hand or by a total
// station: the datum of the result, and checks of it.

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace velamap {

constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"};

struct KnownPoint {
  int marker_id = 0, corner = 0;             // corner 0: the centre
  std::array<std::optional<double>, 3> x_m;  // in the user's frame; a level has z alone
  double sigma_m = 0.0;                      // of each coordinate
  bool is_check = false;  // compared with the result; otherwise it is part of the datum

  int NumCoordinates() const;
};

// "12" for the centre of marker 12, "12.3" for its corner 3, as in the layout file.
std::string PointName(int marker_id, int corner);

// The reason why these points cannot fix a frame regardless of their places: too few points or
// coordinates, or an axis along which none is given. Empty without such a reason. Checks do not
// count.
std::string WhatDatumLacks(const std::vector<KnownPoint>& points);

}  // namespace velamap
