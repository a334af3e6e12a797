#include "exporters/datum/known_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "exporters/datum/datum_consensus.h"
#include "exporters/shape/joint_covariance.h"
#include "exporters/shape/known_distances.h"
#include "importer/base/statistics.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kMaxScaleSigmas = 3.0;
// Errors of the camera and of the print change the size by at most this (reconstruct/adjust). A
// larger change comes from a wrong unit or marker_length.
constexpr double kMaxGrowth = 0.07;

struct KnownPointsInShape {
  std::vector<std::size_t> known_idxs;  // ascending indices into the known points of the layout
  DatumPoints points;                   // in the order of `known_idxs`
  PointSet datum_idxs;                  // indices into `points` of those that are not checks
};

// `covariance` may be null. Points that it lacks count as exact.
KnownPointsInShape CollectKnownPointsInShape(const MarkerShape& shape,
                                             const std::vector<KnownPoint>& known,
                                             const PointCovariance* covariance) {
  KnownPointsInShape present;
  std::vector<CornerId> found;
  DatumPoints& points = present.points;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const ShapeMarker* marker = FindMarker(shape, known[i].marker_id);
    if (marker == nullptr) continue;
    const auto& x = marker->x_in_shape_m[static_cast<std::size_t>(known[i].corner)];
    if (!x) continue;
    if (!known[i].is_check) present.datum_idxs.push_back(points.points.size());
    present.known_idxs.push_back(i);
    found.push_back({known[i].marker_id, known[i].corner});
    points.points.push_back({*x, known[i].x_m, known[i].sigma_m});
    points.center_in_shape_m += *x;
  }
  if (found.empty()) return present;
  const auto count = static_cast<double>(found.size());
  points.center_in_shape_m /= count;
  double squared_m2 = 0.0;
  for (DatumPoint& point : points.points) {
    point.x_m -= points.center_in_shape_m;
    squared_m2 += point.x_m.squaredNorm() / count;
  }
  constexpr double kMinRadius_m = 1e-4;  // keeps divisions by the radius finite
  points.radius_m = std::max(kMinRadius_m, std::sqrt(squared_m2));
  points.covariance_m2 = JointCovarianceOfPoints(covariance, found);
  return present;
}

// The median, over all pairs of points with three known coordinates, of the known distance divided
// by the distance in the shape.
std::optional<double> MedianGrowth(const DatumPoints& points, const PointSet& set) {
  std::vector<double> ratios;
  for (std::size_t a = 0; a < set.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const DatumPoint &first = points.points[set[a]], &second = points.points[set[b]];
      const auto known1 = first.KnownPosition(), known2 = second.KnownPosition();
      const double distance_m = (first.x_m - second.x_m).norm();
      if (known1 && known2 && distance_m > 0) {
        ratios.push_back((*known1 - *known2).norm() / distance_m);
      }
    }
  }
  if (ratios.empty()) return std::nullopt;
  return Median(std::move(ratios));
}

DatumPoints Grown(DatumPoints points, double factor) {
  for (DatumPoint& point : points.points) point.x_m *= factor;
  points.radius_m *= factor;
  points.covariance_m2 *= factor * factor;
  return points;
}

DatumPoints Mirrored(DatumPoints points) {
  for (DatumPoint& point : points.points) {
    if (point.known_m[1]) *point.known_m[1] *= -1;
  }
  return points;
}

// Whether a different pose fits about as well.
bool IsAmbiguous(const DatumPoints& points, const DatumAgreement& agreement) {
  constexpr double kOtherAngle = 0.02;  // rad
  const Rigid3& found = agreement.pose.known_from_centred;
  const double limit = agreement.pose.squared_sigmas + kMaxDatumSigmas * kMaxDatumSigmas;
  for (const DatumPose& start : FindPoses(points, agreement.used)) {
    if (AngularDistance(start.known_from_centred, found) < kOtherAngle) continue;
    const DatumPose other = AdjustPose(points, agreement.used, start.known_from_centred);
    if (other.squared_sigmas < limit &&
        AngularDistance(other.known_from_centred, found) > kOtherAngle) {
      return true;
    }
  }
  return false;
}

// Finds the points that agree. Correct points disagree if the size of the shape is wrong, so if
// more points agree with the scaled shape, these are used for a rigid pose; the difference in size
// is then reported as `scale_change`.
std::optional<DatumAgreement> Agree(const DatumPoints& points, const PointSet& datum) {
  std::optional<DatumAgreement> agreement = FindAgreement(points, datum);
  if (agreement && agreement->used.size() == datum.size()) return agreement;
  const std::optional<double> growth = MedianGrowth(points, datum);
  if (!growth || std::abs(*growth - 1) > kMaxGrowth) return agreement;
  const std::optional<DatumAgreement> grown = FindAgreement(Grown(points, *growth), datum);
  if (!grown || (agreement && grown->used.size() <= agreement->used.size())) return agreement;
  DatumAgreement rigid{
      grown->used, AdjustPose(points, grown->used, grown->pose.known_from_centred), {}};
  rigid.sigmas_off = BaardaStatistics(points, rigid.used, rigid.pose.known_from_centred);
  return rigid;
}

// Whether more points agree if one axis is reversed. It is not enough that some agree, because a
// few points near a plane fit their mirror image.
bool AreMirrored(const DatumPoints& points, const PointSet& datum,
                 const std::optional<DatumAgreement>& agreement) {
  const std::size_t num_agreeing = agreement ? agreement->used.size() : 0;
  if (num_agreeing == datum.size()) return false;
  const std::optional<DatumAgreement> mirrored = FindAgreement(Mirrored(points), datum);
  return mirrored && mirrored->used.size() > num_agreeing;
}

// The probable cause of a gross difference in size between the points and the shape; empty if there
// is no such difference.
std::string WrongSize(const DatumPoints& points, const PointSet& datum) {
  const std::optional<double> growth = MedianGrowth(points, datum);
  if (!growth || std::abs(*growth - 1) <= kMaxGrowth) return "";
  if (std::abs(*growth / kMmPerM - 1) <= kMaxGrowth) {
    return "they are 1000 times as far apart as in the shape: give metres, not millimetres";
  }
  return fmt::format(
      "they are {:.4g} times as far apart as in the shape: check their unit (m), their ids and "
      "corners, and marker_length",
      *growth);
}

// Sets the reason why the points give no frame, with the probable cause.
void Refuse(const DatumPoints& points, const PointSet& datum, bool are_mirrored,
            KnownPointFit* fit) {
  std::string cause = WrongSize(points, datum);
  if (cause.empty()) {
    const std::string open =
        UndeterminedMotions(points, datum, FindPoses(points, datum).front().known_from_centred);
    if (!open.empty()) {
      fit->reason = "the known points leave " + open + " open";
      return;
    }
    cause = are_mirrored
                ? "they fit with one axis reversed: give coordinates in a right-handed frame"
                : fmt::format(
                      "no more than half of {} agree to {:g} sigmas: check their ids, "
                      "corners and sigmas",
                      datum.size(), kMaxDatumSigmas);
  }
  fit->is_contradicted = true;
  fit->reason = "the known points and the shape contradict each other; " + cause;
}

// WhatDatumLacks() for the points that are in the shape, with the points that are missing there.
std::string Lack(const std::vector<ComparedPoint>& points) {
  std::vector<KnownPoint> found;
  std::vector<std::string> missing;
  for (const ComparedPoint& point : points) {
    const KnownPoint& known = point.known;
    if (point.state != PointState::kNotInShape) {
      found.push_back(known);
    } else if (!known.is_check) {
      missing.push_back(PointName(known.marker_id, known.corner));
    }
  }
  std::string lack = WhatDatumLacks(found);
  if (lack.empty() || missing.empty()) return lack;
  return fmt::format("the known points in the shape do not suffice: {} ({} not reconstructed)",
                     lack, fmt::join(missing, " "));
}

// Compares every known point that is in the shape with its coordinates, in the known frame.
void ComparePoints(const KnownPointsInShape& present, const DatumAgreement& agreement,
                   KnownPointFit* fit) {
  const Rigid3& known_from_centred = agreement.pose.known_from_centred;
  for (std::size_t i = 0; i < present.known_idxs.size(); ++i) {
    ComparedPoint& compared = fit->points[present.known_idxs[i]];
    const Eigen::Vector3d x_m = known_from_centred * present.points.points[i].x_m;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& known_m = compared.known.x_m[axis];
      const auto row = static_cast<Eigen::Index>(axis);
      if (known_m) compared.difference_m[row] = x_m[row] - *known_m;
    }
    compared.sigmas_off = agreement.sigmas_off[i];
    const bool is_used = std::binary_search(agreement.used.begin(), agreement.used.end(), i);
    if (compared.known.is_check) {
      compared.state =
          compared.sigmas_off > kMaxCheckSigmas ? PointState::kFailed : PointState::kPassed;
    } else {
      compared.state = is_used ? PointState::kUsed : PointState::kLeftOut;
    }
  }
}

}  // namespace

bool KnownPointFit::ContradictsScale() const {
  return scale_change && std::abs(scale_change->value) > kMaxScaleSigmas * scale_change->sigma;
}

KnownPointFit FitKnownPoints(const MarkerShape& shape, const Layout& layout,
                             const PointCovariance* covariance, double scale_sigma) {
  KnownPointFit fit;
  for (const KnownPoint& known : layout.known_points) fit.points.push_back({known});
  if (fit.points.empty()) return fit;
  const KnownPointsInShape present =
      CollectKnownPointsInShape(shape, layout.known_points, covariance);
  const DatumPoints& points = present.points;
  for (const std::size_t i : present.known_idxs) fit.points[i].state = PointState::kNotCompared;
  fit.reason = Lack(fit.points);
  if (!fit.reason.empty()) return fit;
  const std::optional<DatumAgreement> agreement = Agree(points, present.datum_idxs);
  const bool are_mirrored = AreMirrored(points, present.datum_idxs, agreement);
  if (!agreement || are_mirrored) {
    Refuse(points, present.datum_idxs, are_mirrored, &fit);
    return fit;
  }
  if (IsAmbiguous(points, *agreement)) {
    fit.reason =
        "the known points fit in two places; add another point, roughly measured and with a large "
        "sigma if need be";
    return fit;
  }
  const Rigid3& known_from_centred = agreement->pose.known_from_centred;
  fit.known_from_shape = {
      known_from_centred.rotation,
      known_from_centred.translation - known_from_centred.rotation * points.center_in_shape_m};
  ComparePoints(present, *agreement, &fit);
  fit.scale_change = EstimateScaleChange(points, agreement->used, known_from_centred);
  if (fit.scale_change && covariance == nullptr) {
    fit.scale_change->sigma = std::hypot(fit.scale_change->sigma, scale_sigma);
  }
  const int redundancy = NumCoordinates(points, agreement->used) - kNumPoseParameters;
  if (redundancy > 0) {
    fit.residual_in_sigmas = std::sqrt(agreement->pose.squared_sigmas / redundancy);
  }
  return fit;
}

FrameAttempt FrameOfKnownPoints(const KnownPointFit& fit) {
  if (!fit.known_from_shape) return {std::nullopt, fit.reason};
  ShapeFrame frame;
  frame.frame_from_shape = *fit.known_from_shape;
  frame.name = "known points";
  int num_points = 0, num_coordinates = 0;
  for (const ComparedPoint& point : fit.points) {
    if (point.state != PointState::kUsed) continue;
    const KnownPoint& known = point.known;
    ++num_points;
    num_coordinates += known.NumCoordinates();
    frame.name += " " + PointName(known.marker_id, known.corner);
    if (known.NumCoordinates() == 3) continue;
    frame.name += ":";
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (known.x_m[axis]) frame.name += kAxisNames[axis];
    }
  }
  frame.description = fmt::format(
      "the frame in which these points were measured, by {} coordinates of {} points; z is taken "
      "as up",
      num_coordinates, num_points);
  frame.up_in_frame = Eigen::Vector3d::UnitZ();
  return {frame, ""};
}

}  // namespace velamap
