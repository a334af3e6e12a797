// The points of a datum that agree with each other and with the shape.

#pragma once

#include <optional>
#include <vector>

#include "exporters/datum/datum_fit.h"

namespace velamap {

// A point that is this many sigmas (SigmasAgainst()) from where the others put it contradicts them.
constexpr double kMaxDatumSigmas = 4.0;

struct DatumAgreement {
  PointSet used;
  DatumPose pose;                  // adjusted to them
  std::vector<double> sigmas_off;  // of all points
};

// The largest subset of `candidates` whose points agree and which determines the pose, if it has
// more than half of them. A subset that leaves candidates out needs more than six coordinates,
// because a pose fits any six, and no point would be checked by the others.
std::optional<DatumAgreement> FindAgreement(const DatumPoints& points, const PointSet& candidates);

}  // namespace velamap
