// The uncertainty that a marker-aware bundle adjustment finds for its result. It is stored in the
// model's folder as uncertainty.bin, which COLMAP ignores. A model with this file is metric (m).

#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "reconstruct/geometry/point_covariance.h"
#include "reconstruct/model/calibration_evidence.h"
#include "reconstruct/model/model.h"

namespace velamap {

inline constexpr char kUncertaintyFileName[] = "uncertainty.bin";

struct AdjustmentUncertainty {
  // Covariance after a least-squares rigid alignment of all points with their true positions (inner
  // constraints; Triggs et al., "Bundle Adjustment - A Modern Synthesis", 2000, section 9), because
  // images and markers do not determine a rigid motion of the whole. Includes the variance factor
  // of the observations.
  PointCovariance points;
  // 1 sigma of the common scale of all points, as a fraction, from corner noise, print tolerance
  // and apparent inset together. `points` includes it.
  double relative_scale_sigma = 0.0;
  // The part of relative_scale_sigma that no image shows, because it is assumed for the print
  // (MarkerAdjustmentOptions::common_print_tolerance). 0 where measured distances give the scale.
  double print_scale_sigma = 0.0;
  // Sum of squares of the weighted corner residuals / redundancy. 1 where the corners' sigmas are
  // right.
  double variance_factor = 1.0;
  // Factor of the corners' sigmas in `points` that accounts for errors that several corners have in
  // common; such errors move the shape farther than independent ones. 1 where none are found.
  double correlation_factor = 1.0;
  // Fraction of the used corners with residuals above 4 calibrated sigmas (without the correlation
  // factor).
  double share_above_4_sigma = 0.0;
  // How far corners appear inside of their true place along x and y of the marker. 0: not
  // estimated.
  double apparent_inset_px = 0.0;
  double apparent_inset_sigma_px = 0.0;
  // Readout time, from the first row of an image to the last. A sigma of 0: not estimated.
  double rolling_shutter_s = 0.0;
  double rolling_shutter_sigma_s = 0.0;
  // The markers bend with a curved surface, so their sides are chords (SetChords()).
  bool markers_bend = false;
  CalibrationEvidence calibration;
  std::uint64_t model_hash = 0;  // of the points of its model; 0 if the file lacks it
};

// The file in `folder`. ReadUncertainty throws InputError that names the file if it is missing (see
// HasUncertainty), truncated or of another format. `model` is the model in the folder, whose hash
// the file holds.
void WriteUncertainty(const AdjustmentUncertainty& uncertainty, const Model& model,
                      const std::string& folder);
bool HasUncertainty(const std::string& folder);
AdjustmentUncertainty ReadUncertainty(const std::string& folder);

// The uncertainty of the model in `folder`; nothing if there is none. Throws InputError as
// ReadUncertainty() does, and if it belongs to another model. Warns if the file does not say which
// model it belongs to, as in earlier versions.
std::optional<AdjustmentUncertainty> ReadUncertaintyOf(const Model& model,
                                                       const std::string& folder);

}  // namespace velamap
