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

// Columns are the half axes of the 1 sigma ellipsoid of the centre, m, longest last. Without a
// joint covariance they are along x, y and z.
std::optional<Eigen::Matrix3d> CenterEllipsoid(const ReportInput& input,
                                               const ShapeMarker& marker) {
  std::optional<Eigen::Matrix3d> covariance;
  const PointCovariance* points =
      input.uncertainty != nullptr ? &input.uncertainty->points : nullptr;
  if (PointSigma(points, marker.marker_id, 0)) {
    covariance = JointCovarianceOfPoints(points, {{marker.marker_id, 0}});
  }
  if (!covariance && marker.sigma_m[0]) {
    covariance = marker.sigma_m[0]->cwiseAbs2().asDiagonal().toDenseMatrix();
  }
  if (!covariance) return std::nullopt;
  const SymmetricEigen eigen = DecomposeSymmetric(*covariance);
  const Eigen::Vector3d sigmas = eigen.values.cwiseMax(0).cwiseSqrt();
  return eigen.vectors * sigmas.asDiagonal();
}

void AddWholeMarker(const ReportInput& input, const ShapeMarker& marker, ReportJsonValue* json) {
  const double length_m = MarkerLength(input.layout, marker.marker_id);
  const double mean_side_m = MeanSide(MarkerSides(marker));
  (*json)["centre"] = VectorJson(*marker.x_in_shape_m[0]);
  (*json)["length_mm"] = kMmPerM * length_m;
  (*json)["side_deviation_percent"] = 100 * (mean_side_m / length_m - 1);
  (*json)["area_deviation_percent"] = AreaDeviationPercent(marker, input.layout);
  if (const auto ellipsoid = CenterEllipsoid(input, marker)) {
    (*json)["sigma_mm"] = kMmPerM * ellipsoid->norm();
    (*json)["ellipsoid"] = {VectorJson(ellipsoid->col(0)), VectorJson(ellipsoid->col(1)),
                            VectorJson(ellipsoid->col(2))};
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
    if (marker.IsWhole()) AddWholeMarker(input, marker, &json);
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
