#include <algorithm>
#include <cmath>

#include "exporters/report/report_json.h"
#include "exporters/shape/joint_covariance.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/geometry/symmetric_eigen.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

struct ErrorSum {
  int count = 0;
  double sum_px = 0.0;
};

// Errors by marker id. Points behind their camera have none.
std::map<int, ErrorSum> ErrorsByMarker(const std::vector<ObservationError>& errors) {
  std::map<int, ErrorSum> errors_of;
  for (const ObservationError& error : errors) {
    if (!IsCornerPoint3DId(error.point3D_id) || !std::isfinite(error.error_px)) continue;
    ErrorSum& marker = errors_of[CornerFromPoint3DId(error.point3D_id).marker_id];
    ++marker.count;
    marker.sum_px += error.error_px;
  }
  return errors_of;
}

// Covariance of the centre, m^2. Without a joint covariance it is that of the sigmas of its
// coordinates.
std::optional<Eigen::Matrix3d> CenterCovariance(const PointCovariance* points,
                                                const ShapeMarker& marker) {
  if (PointSigma(points, marker.marker_id, 0)) {
    return JointCovarianceOfPoints(points, {{marker.marker_id, 0}});
  }
  if (!marker.sigma_m[0]) return std::nullopt;
  return marker.sigma_m[0]->cwiseAbs2().asDiagonal().toDenseMatrix();
}

// Columns are the half axes of the 1 sigma ellipsoid, m, longest last.
Eigen::Matrix3d EllipsoidOf(const Eigen::Matrix3d& covariance) {
  const SymmetricEigen eigen = DecomposeSymmetric(covariance);
  const Eigen::Vector3d sigmas = eigen.values.cwiseMax(0).cwiseSqrt();
  return eigen.vectors * sigmas.asDiagonal();
}

// `own` is the covariance without the errors that all markers share. Far from the origin of the
// frame these are much larger, and would draw all ellipsoids as needles that point there.
void AddWholeMarker(const ReportInput& input, const PointCovariance* own, const ShapeMarker& marker,
                    ReportJsonValue* json) {
  const double length_m = MarkerLength(input.layout, marker.marker_id);
  const double mean_side_m = MeanSide(MarkerSides(marker));
  (*json)["centre"] = VectorJson(*marker.x_in_shape_m[0]);
  (*json)["length_mm"] = kMmPerM * length_m;
  (*json)["side_deviation_percent"] = 100 * (mean_side_m / length_m - 1);
  (*json)["area_deviation_percent"] = AreaDeviationPercent(marker, input.layout);
  const PointCovariance* points =
      input.uncertainty != nullptr ? &input.uncertainty->points : nullptr;
  if (const auto covariance = CenterCovariance(points, marker)) {
    (*json)["sigma_mm"] = kMmPerM * std::sqrt(covariance->trace());
  }
  if (const auto covariance = CenterCovariance(own, marker)) {
    const Eigen::Matrix3d axes = EllipsoidOf(*covariance);
    (*json)["ellipsoid"] = {VectorJson(axes.col(0)), VectorJson(axes.col(1)),
                            VectorJson(axes.col(2))};
  }
}

}  // namespace

ReportJsonValue VectorJson(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

double AreaDeviationPercent(const ShapeMarker& marker, const Layout& layout) {
  const double length_m = MarkerLength(layout, marker.marker_id);
  return 100 * (MarkerArea(marker) / (length_m * length_m) - 1);
}

ReportJsonValue MarkersJson(const ReportInput& input, const std::vector<ObservationError>& errors) {
  const std::map<int, ErrorSum> errors_of = ErrorsByMarker(errors);
  const std::optional<PointCovariance> own =
      WithoutSharedErrors(input.uncertainty != nullptr ? &input.uncertainty->points : nullptr);
  ReportJsonValue markers = ReportJsonValue::array();
  for (const ShapeMarker& marker : input.shape.markers) {
    ReportJsonValue json = {{"id", marker.marker_id}, {"part", marker.part}};
    ReportJsonValue corners = ReportJsonValue::array();
    int num_frames = 0;
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const auto& x = marker.x_in_shape_m[corner];
      corners.push_back(x ? VectorJson(*x) : ReportJsonValue());
      num_frames = std::max(num_frames, marker.num_frames[corner]);
    }
    json["corners"] = corners;
    json["num_images"] = num_frames;
    if (marker.IsWhole()) AddWholeMarker(input, own ? &*own : nullptr, marker, &json);
    if (const auto found = errors_of.find(marker.marker_id); found != errors_of.end()) {
      json["num_observations"] = found->second.count;
      json["error_px"] = found->second.sum_px / found->second.count;
    }
    if (const auto found = input.scale.m_per_unit_of.find(marker.marker_id);
        found != input.scale.m_per_unit_of.end()) {
      json["scale_deviation_percent"] = 100 * (found->second / input.scale.m_per_unit - 1);
    }
    markers.push_back(std::move(json));
  }
  return markers;
}

}  // namespace velamap
