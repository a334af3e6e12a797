// What an adjusted pose says about each point, the six degrees of freedom and the size of the
// shape, from the joint covariance of all coordinates.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/datum/datum_pose.h"

namespace velamap {

// How far each point, in the set or not, is from where the others of the set put it. A right point
// is beyond 3 with a probability of 0.27 %, however many of its coordinates are known: for one
// coordinate, it is the difference over its sigma. 0 for a point about which the others say
// nothing. `pose` is the adjusted pose of the set (Baarda, A testing procedure for use in geodetic
// networks, 1968).
std::vector<double> SigmasAgainst(const DatumPoints& points, const PointSet& set,
                                  const Rigid3& pose);

// The motions that the set leaves undetermined (1 sigma above 3 degrees as seen from the centre of
// the points), such as "a turn about z". Empty if there are none.
std::string OpenMotions(const DatumPoints& points, const PointSet& set, const Rigid3& pose);

// The growth of the shape, as a fraction of its size, that would fit the set best.
struct ScaleChange {
  double value = 0.0;
  double sigma = 0.0;
};

// Nothing where the set does not determine it.
std::optional<ScaleChange> EstimateScaleChange(const DatumPoints& points, const PointSet& set,
                                               const Rigid3& pose);

}  // namespace velamap
