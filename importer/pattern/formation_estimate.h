// How light from a printed marker becomes grey values, beyond the blur that each fit finds itself.
//
//   print      dark cells reach ink_spread_mm beyond their outlines
//   lens       scatters the share `halo` of the light by a Gaussian of halo_radius_px
//   camera     edges move by edge_shift_blurs (sigmas of the blur) towards the light side, and the
//              outline of the black square by a further outline_shift_blurs outwards
//   tone       gray = 255 (v - s_amplitude sin(2 pi v)),  v = (light / 255)^(1 / gamma)
//   sharpening sharpened = gray + sharpening (gray - G gray),  G a Gaussian of sharpening_radius_px
//
// A camera blurs linear light and encodes it afterwards, which moves the middle of an encoded edge
// by up to 0.8 blur sigmas towards the dark side. The power covers sRGB and Rec. 709 to a few
// per cent, and with a large gamma the logarithms of flat profiles and HDR video; the sine is the
// S-shaped contrast that many cameras add. A camera that sharpens light instead of grey values
// needs no model of its own: another curve and amount put its edges where they are (test
// SharpenedLightDoesNotMoveSides). What a lens scatters over tens of pixels changes levels, not
// edges. Light and grey values run from 0 to 255.

#pragma once

namespace velamap {

// The defaults are a camera whose grey values are proportional to light, and a perfect print.
struct ImageFormationParameters {
  double gamma = 1.0;
  double s_amplitude = 0.0;
  double sharpening = 0.0;
  double sharpening_radius_px = 1.0;
  double ink_spread_mm = 0.0;
  // Noise filters, compression and tone curves of other shapes move edges by a fraction of their
  // blur, which is the same in all directions of the image. Ink moves them by a length on the
  // paper, which is foreshortened on a slanted marker.
  double edge_shift_blurs = 0.0;
  // The surroundings of a narrow quiet zone, and noise filters that take the zone for noise, move
  // the outline of the black square in addition to the shift of all edges.
  double outline_shift_blurs = 0.0;
  // The images hold 255 minus the recorded grey values, so that inverted prints look upright. Light
  // stays what the camera received: bright cells then have less of it than dark ones.
  bool is_inverted = false;
  // The quiet zone around the black squares of all markers: mean width and 1 sigma of a side, as
  // the prior of each fit. A sigma of 0: unknown.
  double quiet_zone_cells = 1.0;
  double quiet_zone_sigma_cells = 0.0;
  // Weight of the pixels at the corners of the cells' outlines. Printers, noise filters and
  // compression round these corners, which the blur of straight edges does not describe.
  double outline_corner_weight = 1.0;
  // The share is below zero if a camera raises local contrast.
  double halo = 0.0;
  double halo_radius_px = 2.7;
};

// No estimate has more ink than this.
inline constexpr double kMaxInkSpread_mm = 0.3;

struct FormationEstimate {
  ImageFormationParameters parameters;
  int num_samples = 0;      // that could be fitted; 0: the parameters are defaults
  double noise_gray = 0.0;  // robust standard deviation of the residuals, grey levels
  // 1 sigma of the error that all corners share because of uncertain parameters and of effects that
  // no parameter describes: each corner is found this far inside (or outside) its marker along both
  // sides, px.
  double inset_sigma_px = 0.0;
};

}  // namespace velamap
