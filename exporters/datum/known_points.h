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
  // Shape less known coordinates, m; 0 along axes that are not known.
  Eigen::Vector3d difference_m = Eigen::Vector3d::Zero();
  double sigmas_off = 0.0;  // see SigmasOff()
};

struct KnownPointFit {
  std::vector<ComparedPoint> points;       // in the order of the layout
  std::optional<Rigid3> known_from_shape;  // not with fewer points than determine it
  std::string reason;            // why there is none; empty for a layout without known points
  bool is_contradicted = false;  // that reason is that points and shape contradict each other
  // Root of the sum of squared residuals over their variances, per redundant coordinate: 1 for
  // right sigmas. Nothing without a redundant coordinate.
  std::optional<double> residual_in_sigmas;
  std::optional<AskedGrowth> growth;  // that the points ask of the size of the shape

  // Whether the size that the points ask for is more than three sigmas from that of the shape.
  bool DoubtsScale() const;
};

// Fits the shape to the largest set of points that agree with each other. `covariance`, of the
// corners of the shape (may be null), weighs the points beside their own sigmas and is part of the
// sigmas of differences. Without it, or for points that it lacks, the shape counts as exact, but
// for the sigma of its scale (a ratio) if that is known otherwise.
KnownPointFit FitKnownPoints(const MarkerShape& shape, const Layout& layout,
                             const PointCovariance* covariance = nullptr, double scale_sigma = 0.0);

// The frame that the fit gives, for ChooseFrame(). Its name has the points that it rests on.
FrameAttempt FrameOfKnownPoints(const KnownPointFit& fit);

}  // namespace velamap
