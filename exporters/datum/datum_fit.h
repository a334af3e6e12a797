// Statistics of an adjusted pose, from the joint covariance of all coordinates: outliers,
// undetermined degrees of freedom, and the size of the shape. `known_from_centred` maps
// DatumPoint::x_m, which is relative to the centre, to the known frame.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/datum/datum_equations.h"
#include "importer/base/statistics.h"

namespace velamap {

// For every point, whether in the set or not, how many sigmas it is away from where the other
// points of the set put it (Baarda, A testing procedure for use in geodetic networks, 1968). For a
// point with one coordinate, this is the difference divided by its sigma. For more coordinates it
// is scaled so that a correct point still exceeds 3 with a probability of 0.27 %. It is 0 for a
// point that the others do not constrain. `known_from_centred` is adjusted to the set.
std::vector<double> BaardaStatistics(const DatumPoints& points, const PointSet& set,
                                     const Rigid3& known_from_centred);

// Describes the motions that the set leaves undetermined, such as "a turn about z"; empty if there
// are none. A motion is undetermined if its sigma moves points at the RMS distance from the centre
// by more than about 3 degrees as seen from there.
std::string UndeterminedMotions(const DatumPoints& points, const PointSet& set,
                                const Rigid3& known_from_centred);

// The relative change of the size of the shape that would fit the set best; nothing if the set does
// not determine the size (a sigma of 0.5 or more).
std::optional<UncertainValue> EstimateScaleChange(const DatumPoints& points, const PointSet& set,
                                                  const Rigid3& known_from_centred);

}  // namespace velamap
