// Gives a smooth surface its outline: u is 0 and 1 on luff and leech at every v, and v is 0 and 1
// on foot and head at every u. Between luff and leech, u is the fraction of the length along the
// cloth, so that it names the same place however much is smoothed. The penalties that smooth the
// surface act on one pair of parameters that belongs to the whole cloth, in which its edges are
// curves; forcing the edges to be lines there would bend the surface or leave gaps.

#pragma once

#include "exporters/surface/surface_feet.h"
#include "exporters/surface/surface_smoother.h"

namespace velamap {

// The outline goes through the places of luff and leech, with a cubic spline between them, and
// along those of foot and head. Moves the parameters of all observations with the surface. The new
// poles are linear in the old ones, so that their covariances and shares follow, with the sigma of
// what is extrapolated. Changes nothing and notes it where opposite edges meet.
void TrimToOutline(const SurfaceOutline& outline, SurfaceParameters* parameters,
                   SmoothSurface* smooth);

}  // namespace velamap
