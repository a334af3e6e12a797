// Moves the shape into the frame of the layout's known points, by weighted least squares with a
// rigid transformation, and compares the check points with the result.

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
  kNotCompared,  // the known points give no frame
  kUsed,         // part of the datum
  kLeftOut,      // left out of the datum because it contradicts the others
  kPassed,       // a check within kMaxCheckSigmas
  kFailed,       // a check beyond kMaxCheckSigmas
};

struct ComparedPoint {
  KnownPoint known;
  PointState state = PointState::kNotInShape;
  // Shape minus known coordinates in the known frame, m; 0 along axes without a known coordinate.
  Eigen::Vector3d difference_m = Eigen::Vector3d::Zero();
  double sigmas_off = 0.0;  // see BaardaStatistics()
};

struct KnownPointFit {
  std::vector<ComparedPoint> points;       // in the order of the layout
  std::optional<Rigid3> known_from_shape;  // not set if the points do not determine it
  std::string reason;            // why it is not set; empty for a layout without known points
  bool is_contradicted = false;  // whether the reason is that points and shape disagree
  // The square root of the sum of squared whitened residuals divided by the redundancy. It is about
  // 1 if the sigmas are right. Not set without redundancy.
  std::optional<double> residual_in_sigmas;
  std::optional<UncertainValue> scale_change;  // not set if the points do not determine it

  // Whether the points contradict the size of the shape by more than three sigmas.
  bool ContradictsScale() const;
};

// Fits the shape to the largest set of points that agree with each other. `covariance`, of the
// corners of the shape (may be null), is added to the covariance of the known coordinates. Points
// that it lacks count as exact in the shape. If it is null, the shape is exact except for its
// scale, whose relative sigma `scale_sigma` enters the sigma of `scale_change`.
KnownPointFit FitKnownPoints(const MarkerShape& shape, const Layout& layout,
                             const PointCovariance* covariance = nullptr, double scale_sigma = 0.0);

// The frame of the fit for ChooseFrame(). Its name lists the points that were used.
FrameAttempt FrameOfKnownPoints(const KnownPointFit& fit);

}  // namespace velamap
