// The unit of files whose format names none: OBJ, STL, meshes and points for simulation.

#pragma once

#include "importer/base/option.h"
#include "importer/geometry/units.h"

namespace velamap {

enum class LengthUnit { kMetre, kMillimetre };

inline const Choices<LengthUnit> kLengthUnits = {{LengthUnit::kMetre, "m"},
                                                 {LengthUnit::kMillimetre, "mm"}};

constexpr double UnitsPerM(LengthUnit unit) { return unit == LengthUnit::kMetre ? 1.0 : kMmPerM; }

}  // namespace velamap
