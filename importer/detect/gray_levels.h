// Thresholds on grey levels (0 to 255) that all measurements of marker edges share.

#pragma once

namespace velamap {

// The least contrast between the black and the white of a marker, grey levels. Compression and
// noise can look like a marker of less contrast.
inline constexpr double kMinContrast = 12.0;

// The largest RMS residual of a fit, relative to the contrast. A fit with a larger residual has
// fitted something other than the marker.
inline constexpr double kMaxRelativeRms = 0.2;

// 1 sigma of the noise of a pixel, grey levels; sets how much the priors of a fit weigh.
inline constexpr double kPixelNoise = 3.0;

}  // namespace velamap
