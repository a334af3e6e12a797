// Bend and sag of the luff, and the sheeting angle, with their sigmas.
//
// The luff is the smoothing spline (section_spline.h) through the first markers of the horizontal
// lines, and through all markers of a vertical line that holds at least half of these.

#pragma once

#include <optional>

#include "exporters/sail/section.h"
#include "exporters/sail/section_numbers.h"
#include "exporters/sail/section_twist.h"

namespace velamap {

// `centerline` is directed aft. `foot` holds the azimuth of the boom or of the reference section;
// null without both.
RigNumbers ComputeRigNumbers(const PartContext& context,
                             const std::optional<MarkerPair>& centerline,
                             const ReferenceSection& reference, const NumbersWithGradient* foot);

}  // namespace velamap
