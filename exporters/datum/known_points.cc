#include "exporters/datum/known_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "exporters/datum/datum_consensus.h"
#include "exporters/shape/joint_covariance.h"
#include "exporters/shape/known_distances.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/base/statistics.h"

namespace velamap {
namespace {

constexpr double kMaxScaleSigmas = 3.0;
// Cameras and prints explain that much of a difference in size, see reconstruct/adjust; a wrong
// unit or marker_length is farther off.
constexpr double kMaxGrowth = 0.07;

// The points of the layout that are in the shape.
struct PresentPoints {
  std::vector<std::size_t> idxs;  // in the layout
  DatumPoints points;
  PointSet datum;  // indices into `points` of those that are no checks
};

std::optional<Eigen::Vector3d> PointInShape(const MarkerShape& shape, const KnownPoint& known) {
  const ShapeMarker* marker = FindMarker(shape, known.marker_id);
  return marker == nullptr ? std::nullopt
                           : marker->x_in_shape_m[static_cast<std::size_t>(known.corner)];
}

// The covariance of the points in the shape, with zeros for those that `covariance` lacks.
Eigen::MatrixXd CovarianceOfPoints(const std::vector<KnownPoint>& known,
                                   const PointCovariance* covariance) {
  std::vector<PointGradient> gradients;
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < known.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      PointGradient gradient;
      AddPointGradient(known[i].marker_id, known[i].corner, Eigen::Vector3d::Unit(axis), &gradient);
      if (!HasPointsOf(gradient, covariance)) continue;
      gradients.push_back(std::move(gradient));
      rows.push_back(static_cast<Eigen::Index>(3 * i) + axis);
    }
  }
  const auto size = static_cast<Eigen::Index>(3 * known.size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(size, size);
  if (!rows.empty()) all(rows, rows) = JointCovarianceOf(*covariance, gradients);
  return all;
}

PresentPoints CollectPresent(const MarkerShape& shape, const std::vector<KnownPoint>& known,
                             const PointCovariance* covariance) {
  PresentPoints present;
  std::vector<KnownPoint> found;
  DatumPoints& points = present.points;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const std::optional<Eigen::Vector3d> x = PointInShape(shape, known[i]);
    if (!x) continue;
    if (!known[i].is_check) present.datum.push_back(points.points.size());
    present.idxs.push_back(i);
    found.push_back(known[i]);
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
  constexpr double kMinRadius_m = 1e-4;  // of points in one place, which determine nothing
  points.radius_m = std::max(kMinRadius_m, std::sqrt(squared_m2));
  points.covariance_m2 = CovarianceOfPoints(found, covariance);
  return present;
}

// Distances of the known coordinates over those in the shape: their median over all pairs of points
// with three coordinates.
std::optional<double> MedianGrowth(const DatumPoints& points, const PointSet& set) {
  std::vector<double> ratios;
  const auto position = [](const DatumPoint& point) -> std::optional<Eigen::Vector3d> {
    const auto& known = point.known_m;
    if (!known[0] || !known[1] || !known[2]) return std::nullopt;
    return Eigen::Vector3d(*known[0], *known[1], *known[2]);
  };
  for (std::size_t a = 0; a < set.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const DatumPoint &first = points.points[set[a]], &second = points.points[set[b]];
      const auto known1 = position(first), known2 = position(second);
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

// Whether another pose fits about as well.
bool IsAmbiguous(const DatumPoints& points, const DatumAgreement& agreement) {
  constexpr double kOtherAngle = 0.02;  // rad
  const double limit = agreement.pose.squared_sigmas + kMaxDatumSigmas * kMaxDatumSigmas;
  for (const DatumPose& start : FindPoses(points, agreement.used)) {
    if (AngularDistance(start.pose, agreement.pose.pose) < kOtherAngle) continue;
    const DatumPose other = AdjustPose(points, agreement.used, start.pose);
    if (other.squared_sigmas < limit &&
        AngularDistance(other.pose, agreement.pose.pose) > kOtherAngle) {
      return true;
    }
  }
  return false;
}

// The agreeing points. A wrong size of the shape makes right points disagree: where more of them
// agree with another size, those are taken, and the size is reported.
std::optional<DatumAgreement> Agree(const DatumPoints& points, const PointSet& datum) {
  std::optional<DatumAgreement> agreement = FindAgreement(points, datum);
  if (agreement && agreement->used.size() == datum.size()) return agreement;
  const std::optional<double> growth = MedianGrowth(points, datum);
  if (!growth || std::abs(*growth - 1) > kMaxGrowth) return agreement;
  const std::optional<DatumAgreement> grown = FindAgreement(Grown(points, *growth), datum);
  if (!grown || (agreement && grown->used.size() <= agreement->used.size())) return agreement;
  DatumAgreement rigid{grown->used, AdjustPose(points, grown->used, grown->pose.pose), {}};
  rigid.sigmas_off = SigmasOff(points, rigid.used, rigid.pose.pose);
  return rigid;
}

// Whether more points agree with one axis reversed. Compares numbers, because a few mirrored points
// near a plane fit any shape.
bool AreMirrored(const DatumPoints& points, const PointSet& datum,
                 const std::optional<DatumAgreement>& agreement) {
  const std::size_t num_agreeing = agreement ? agreement->used.size() : 0;
  if (num_agreeing == datum.size()) return false;
  const std::optional<DatumAgreement> mirrored = FindAgreement(Mirrored(points), datum);
  return mirrored && mirrored->used.size() > num_agreeing;
}

// The probable cause if the points have another size than the shape; empty if they have not.
std::string WrongSize(const DatumPoints& points, const PointSet& datum) {
  const std::optional<double> growth = MedianGrowth(points, datum);
  constexpr double kMillimetres = 1e3;
  if (!growth || std::abs(*growth - 1) <= kMaxGrowth) return "";
  if (std::abs(*growth / kMillimetres - 1) <= kMaxGrowth) {
    return "they are 1000 times as far apart as in the shape: give metres, not millimetres";
  }
  return fmt::format(
      "they are {:.4g} times as far apart as in the shape: check their unit (m), their ids and "
      "corners, and marker_length",
      *growth);
}

// Sets the reason why the points do not agree, with the probable cause.
void Refuse(const DatumPoints& points, const PointSet& datum, bool are_mirrored,
            KnownPointFit* fit) {
  std::string cause = WrongSize(points, datum);
  if (cause.empty()) {
    const std::string open = OpenMotions(points, datum, FindPoses(points, datum).front().pose);
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

// What the points in the shape lack for a frame, whatever their places.
std::string Lack(const std::vector<ComparedPoint>& points, const PresentPoints& present) {
  std::vector<KnownPoint> found;
  std::vector<std::string> missing;
  for (const std::size_t i : present.idxs) found.push_back(points[i].known);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool is_found = std::binary_search(present.idxs.begin(), present.idxs.end(), i);
    const KnownPoint& known = points[i].known;
    if (!is_found && !known.is_check) missing.push_back(PointName(known.marker_id, known.corner));
  }
  std::string lack = WhatDatumLacks(found);
  if (lack.empty() || missing.empty()) return lack;
  return fmt::format("the known points in the shape do not suffice: {} ({} not reconstructed)",
                     lack, fmt::join(missing, " "));
}

// Compares every point in the shape with its coordinates in the frame of the agreement.
void ComparePoints(const PresentPoints& present, const DatumAgreement& agreement,
                   KnownPointFit* fit) {
  const Rigid3& pose = agreement.pose.pose;
  for (std::size_t i = 0; i < present.idxs.size(); ++i) {
    ComparedPoint& compared = fit->points[present.idxs[i]];
    const Eigen::Vector3d x_m = pose * present.points.points[i].x_m;
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

bool KnownPointFit::DoubtsScale() const {
  return growth && std::abs(growth->value) > kMaxScaleSigmas * growth->sigma;
}

KnownPointFit FitKnownPoints(const MarkerShape& shape, const Layout& layout,
                             const PointCovariance* covariance, double scale_sigma) {
  KnownPointFit fit;
  for (const KnownPoint& known : layout.known_points) fit.points.push_back({known});
  if (fit.points.empty()) return fit;
  const PresentPoints present = CollectPresent(shape, layout.known_points, covariance);
  const DatumPoints& points = present.points;
  for (const std::size_t i : present.idxs) fit.points[i].state = PointState::kNotCompared;
  fit.reason = Lack(fit.points, present);
  if (!fit.reason.empty()) return fit;
  const std::optional<DatumAgreement> agreement = Agree(points, present.datum);
  const bool are_mirrored = AreMirrored(points, present.datum, agreement);
  if (!agreement || are_mirrored) {
    Refuse(points, present.datum, are_mirrored, &fit);
    return fit;
  }
  if (IsAmbiguous(points, *agreement)) {
    fit.reason =
        "the known points fit in two places; add another point, roughly measured and with a large "
        "sigma if need be";
    return fit;
  }
  const Rigid3& pose = agreement->pose.pose;
  fit.known_from_shape = {pose.rotation,
                          pose.translation - pose.rotation * points.center_in_shape_m};
  ComparePoints(present, *agreement, &fit);
  fit.growth = GrowthAskedFor(points, agreement->used, pose);
  if (fit.growth && covariance == nullptr) {
    fit.growth->sigma = std::hypot(fit.growth->sigma, scale_sigma);
  }
  const auto redundancy = Linearize(points, agreement->used, pose).residuals_m.size() - 6;
  if (redundancy > 0) {
    fit.residual_in_sigmas =
        std::sqrt(agreement->pose.squared_sigmas / static_cast<double>(redundancy));
  }
  return fit;
}

FrameAttempt FrameOfKnownPoints(const KnownPointFit& fit) {
  if (!fit.known_from_shape) return {std::nullopt, fit.reason};
  ShapeFrame frame;
  frame.kind = FrameKind::kKnownPoints;
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
      "the frame in which these points were measured, by {} coordinates of {}; z is taken as up",
      num_coordinates, num_points);
  frame.up_in_frame = Eigen::Vector3d::UnitZ();
  return {frame, ""};
}

}  // namespace velamap
