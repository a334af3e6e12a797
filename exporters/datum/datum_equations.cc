#include "exporters/datum/datum_equations.h"

#include "importer/geometry/pose_step.h"

namespace velamap {

std::optional<Eigen::Vector3d> DatumPoint::KnownPosition() const {
  if (!known_m[0] || !known_m[1] || !known_m[2]) return std::nullopt;
  return Eigen::Vector3d(*known_m[0], *known_m[1], *known_m[2]);
}

int NumCoordinates(const DatumPoints& points, const PointSet& set) {
  int count = 0;
  for (const std::size_t i : set) {
    for (const auto& known : points.points[i].known_m) count += known.has_value();
  }
  return count;
}

DatumEquations LinearizeDatum(const DatumPoints& points, const PointSet& set,
                              const Rigid3& known_from_centred) {
  const auto max_rows = static_cast<Eigen::Index>(3 * set.size());
  DatumEquations equations{{0},
                           Eigen::VectorXd(max_rows),
                           decltype(DatumEquations::by_pose)(max_rows, 6),
                           Eigen::VectorXd(max_rows)};
  const Eigen::Matrix3d rotation = known_from_centred.rotation.toRotationMatrix();
  Eigen::Index row = 0;
  for (const std::size_t i : set) {
    const DatumPoint& point = points.points[i];
    const Eigen::Vector3d turned = rotation * point.x_m;
    const Eigen::Matrix3d by_turn = -CrossMatrix(turned) / points.radius_m;
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<double>& known_m = point.known_m[static_cast<std::size_t>(axis)];
      if (!known_m) continue;
      equations.residuals_m[row] = turned[axis] + (known_from_centred.translation[axis] - *known_m);
      equations.by_pose.row(row) << by_turn.row(axis), Eigen::RowVector3d::Unit(axis);
      equations.by_scale_m[row] = turned[axis];
      ++row;
    }
    equations.begins.push_back(row);
  }
  equations.residuals_m.conservativeResize(row);
  equations.by_pose.conservativeResize(row, Eigen::NoChange);
  equations.by_scale_m.conservativeResize(row);
  return equations;
}

Eigen::MatrixXd ResidualCovariance(const DatumPoints& points, const PointSet& set,
                                   const Eigen::Quaterniond& known_from_centred) {
  const Eigen::Matrix3d rotation = known_from_centred.toRotationMatrix();
  const auto num_rows = static_cast<Eigen::Index>(3 * set.size());
  Eigen::MatrixXd covariance(num_rows, num_rows);
  std::vector<Eigen::Index> given;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const DatumPoint& point = points.points[set[i]];
    const auto row = static_cast<Eigen::Index>(3 * i), from = static_cast<Eigen::Index>(3 * set[i]);
    for (std::size_t j = 0; j < set.size(); ++j) {
      covariance.block<3, 3>(row, static_cast<Eigen::Index>(3 * j)) =
          rotation * points.covariance_m2.block<3, 3>(from, static_cast<Eigen::Index>(3 * set[j])) *
          rotation.transpose();
    }
    covariance.block<3, 3>(row, row).diagonal().array() += point.sigma_m * point.sigma_m;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (point.known_m[axis]) given.push_back(row + static_cast<Eigen::Index>(axis));
    }
  }
  return covariance(given, given);
}

}  // namespace velamap
