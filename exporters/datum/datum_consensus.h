// Finds the points of a datum that agree with each other and with the shape.

#pragma once

#include <optional>
#include <vector>

#include "exporters/datum/datum_pose.h"

namespace velamap {

// A point that is more sigmas (BaardaStatistics()) away from where the others put it contradicts
// them.
constexpr double kMaxDatumSigmas = 4.0;

struct DatumAgreement {
  PointSet used;
  DatumPose pose;                  // adjusted to the used points
  std::vector<double> sigmas_off;  // BaardaStatistics() of all points
};

// Searches (RANSAC) for the largest subset of `candidates` whose points agree and determine the
// pose. Returns nothing if it has no more than half of the candidates. A subset that leaves
// candidates out needs more than six coordinates, because a pose fits any six and the points would
// not check each other.
std::optional<DatumAgreement> FindAgreement(const DatumPoints& points, const PointSet& candidates);

}  // namespace velamap
