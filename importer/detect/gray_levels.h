// What counts as a marker in grey levels (0..255), for everything that looks at its edges.

#pragma once

namespace velamap {

// Between the black and the white of a marker; with less, compression and noise look the same.
inline constexpr double kMinContrast = 12.0;

// Of the residuals of a fit, relative to the contrast; with more, it has fitted something else.
inline constexpr double kMaxRelativeRms = 0.2;

// Of a pixel; sets how much the priors of a fit weigh.
inline constexpr double kPixelNoise = 3.0;

}  // namespace velamap
