// What counts as a marker in grey levels (0..255), for everything that looks at its edges.

#pragma once

namespace velamap {

// The least contrast between the black and the white of a marker, grey levels. Compression and
// noise can look like a marker of less contrast.
inline constexpr double kMinContrast = 12.0;

// The largest RMS residual of a fit, relative to the contrast. A fit that leaves more has fitted
// something else.
inline constexpr double kMaxRelativeRms = 0.2;

// 1 sigma of the noise of a pixel, grey levels; sets how much the priors of a fit weigh.
inline constexpr double kPixelNoise = 3.0;

}  // namespace velamap
