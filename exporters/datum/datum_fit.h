// Statistics of an adjusted pose, from the joint covariance of all coordinates: outliers,
// undetermined degrees of freedom, and the size of the shape.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/datum/datum_pose.h"

namespace velamap {

// For every point, whether in the set or not, how many sigmas it is away from where the other
// points of the set put it (Baarda, A testing procedure for use in geodetic networks, 1968). For a
// point with one coordinate, this is the difference divided by its sigma. For more coordinates it
// is scaled so that a correct point still exceeds 3 with a probability of 0.27 %. It is 0 for a
// point that the others do not constrain. `pose` is the adjusted pose of the set.
std::vector<double> SigmasAgainst(const DatumPoints& points, const PointSet& set,
                                  const Rigid3& pose);

// Describes the motions that the set leaves undetermined, such as "a turn about z"; empty if there
// are none. A motion is undetermined if its sigma moves points at the RMS distance from the centre
// by more than about 3 degrees as seen from there.
std::string OpenMotions(const DatumPoints& points, const PointSet& set, const Rigid3& pose);

// The relative change of the size of the shape that would fit the set best.
struct ScaleChange {
  double value = 0.0;
  double sigma = 0.0;
};

// Returns nothing if the set does not determine the size (a sigma of 0.5 or more).
std::optional<ScaleChange> EstimateScaleChange(const DatumPoints& points, const PointSet& set,
                                               const Rigid3& pose);

}  // namespace velamap
