// The frame of the layout's known points: the shape is moved to their coordinates, rigidly and
// without scale, by weighted least squares; checks are compared with the result.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/datum/datum_fit.h"
#include "exporters/shape/marker_shape.h"
#include "exporters/shape/shape_frame.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

enum class PointState {
  kNotInShape,   // not reconstructed
  kNotCompared,  // there is no frame of the known points
  kUsed,         // part of the datum
  kLeftOut,      // contradicts the others
  kPassed,       // a check within kMaxCheckSigmas
  kFailed,
};

struct ComparedPoint {
  KnownPoint known;
  PointState state = PointState::kNotInShape;
  // Shape minus known coordinates, m; 0 along axes that are not known.
  Eigen::Vector3d difference_m = Eigen::Vector3d::Zero();
  double sigmas_off = 0.0;  // see SigmasAgainst()
};

struct KnownPointFit {
  std::vector<ComparedPoint> points;       // in the order of the layout
  std::optional<Rigid3> known_from_shape;  // nothing where the points do not determine it
  std::string reason;            // why there is none; empty for a layout without known points
  bool is_contradicted = false;  // whether the reason is that points and shape disagree
  // Root of the sum of squared normalized residuals per redundant coordinate: about 1 if the sigmas
  // are right. Nothing without a redundant coordinate.
  std::optional<double> residual_in_sigmas;
  std::optional<ScaleChange> scale_change;  // nothing where the points do not determine it

  // Whether the points contradict the size of the shape by more than three sigmas.
  bool ContradictsScale() const;
};

// Fits the shape to the largest set of points that agree with each other. `covariance`, of the
// corners of the shape (may be null), enters the weights and the sigmas of differences beside the
// points' own sigmas. Without it, or for points that it lacks, the shape counts as exact except for
// `scale_sigma`, the sigma of its scale as a ratio.
KnownPointFit FitKnownPoints(const MarkerShape& shape, const Layout& layout,
                             const PointCovariance* covariance = nullptr, double scale_sigma = 0.0);

// The frame that the fit gives, for ChooseFrame(). Its name lists the points that were used.
FrameAttempt FrameOfKnownPoints(const KnownPointFit& fit);

}  // namespace velamap
