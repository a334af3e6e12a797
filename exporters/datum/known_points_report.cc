#include "exporters/datum/known_points_report.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "importer/base/statistics.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

std::string NameOf(const ComparedPoint& point) {
  return PointName(point.known.marker_id, point.known.corner);
}

bool IsCompared(const ComparedPoint& point) {
  return point.state != PointState::kNotInShape && point.state != PointState::kNotCompared;
}

// Statistics of the distances, mm, of the points in one of these states.
Statistics Distances(const KnownPointFit& fit, const std::vector<PointState>& states) {
  std::vector<double> distances_mm;
  for (const ComparedPoint& point : fit.points) {
    if (std::find(states.begin(), states.end(), point.state) == states.end()) continue;
    distances_mm.push_back(kMmPerM * point.difference_m.norm());
  }
  return ComputeStatistics(std::move(distances_mm));
}

std::string StateText(PointState state) {
  switch (state) {
    case PointState::kNotInShape:
      return "not reconstructed";
    case PointState::kNotCompared:
      return "not compared: the known points give no frame";
    case PointState::kUsed:
      return "used";
    case PointState::kLeftOut:
      return "left out: contradicts the others";
    case PointState::kPassed:
      return "pass";
    case PointState::kFailed:
      return "fail";
  }
  return {};
}

Metrics RowOf(const ComparedPoint& point) {
  Metrics row = {{"point", NameOf(point)},
                 {"use", std::string(point.known.is_check ? "check" : "frame")},
                 {"known_sigma_mm", kMmPerM * point.known.sigma_m}};
  if (IsCompared(point)) {
    for (std::size_t axis = 0; axis < kAxisNames.size(); ++axis) {
      if (!point.known.x_m[axis]) continue;
      row.push_back({fmt::format("d{}_mm", kAxisNames[axis]),
                     kMmPerM * point.difference_m[static_cast<Eigen::Index>(axis)]});
    }
    row.push_back({"distance_mm", kMmPerM * point.difference_m.norm()});
    row.push_back({"in_sigmas", point.sigmas_off});
  }
  row.push_back({"result", StateText(point.state)});
  return row;
}

// Such as "45.3 12.1 mm (5.2 sigmas)".
std::string ShortText(const ComparedPoint& point) {
  return fmt::format("{} {:.3g} mm ({:.1f} sigmas)", NameOf(point),
                     kMmPerM * point.difference_m.norm(), point.sigmas_off);
}

// The compared point that is farthest off; a failed check is worse than any other point. Null if
// nothing checks the points: as many coordinates as the frame needs always fit.
const ComparedPoint* WorstPoint(const KnownPointFit& fit) {
  const auto badness = [](const ComparedPoint& point) {
    return std::make_pair(point.state == PointState::kFailed, point.sigmas_off);
  };
  const ComparedPoint* worst = nullptr;
  bool is_checked = fit.residual_in_sigmas.has_value();
  for (const ComparedPoint& point : fit.points) {
    if (!IsCompared(point)) continue;
    is_checked = is_checked || point.state != PointState::kUsed;
    if (worst == nullptr || badness(*worst) < badness(point)) worst = &point;
  }
  return is_checked ? worst : nullptr;
}

std::string ScaleChangeText(const UncertainValue& change) {
  return fmt::format("{:+.3f} +- {:.3f} %", 100.0 * change.value, 100.0 * change.sigma);
}

}  // namespace

void AddMetrics(const KnownPointFit& fit, MetricsReport* report) {
  if (fit.points.empty()) return;
  Metrics& metrics = report->metrics;
  metrics.push_back({"known_point_residual_mm", Distances(fit, {PointState::kUsed})});
  if (fit.residual_in_sigmas) {
    metrics.push_back({"known_point_residual_in_sigmas", *fit.residual_in_sigmas});
  }
  AddEstimate("known_point_growth", "percent", fit.scale_change, 100.0, &metrics);
  metrics.push_back(
      {"check_point_error_mm", Distances(fit, {PointState::kPassed, PointState::kFailed})});
  metrics.push_back({"num_failed_check_points", CountPoints(fit, PointState::kFailed)});
  if (!fit.reason.empty()) metrics.push_back({"known_points_note", fit.reason});
  MetricTable table{"known_points", true, {}};
  for (const ComparedPoint& point : fit.points) table.rows.push_back(RowOf(point));
  report->tables.push_back(std::move(table));
}

int CountPoints(const KnownPointFit& fit, PointState state) {
  return static_cast<int>(
      std::count_if(fit.points.begin(), fit.points.end(),
                    [state](const ComparedPoint& point) { return point.state == state; }));
}

std::string KnownPointsText(const KnownPointFit& fit) {
  const auto num_checks = static_cast<int>(
      std::count_if(fit.points.begin(), fit.points.end(),
                    [](const ComparedPoint& point) { return point.known.is_check; }));
  const int num_datum = static_cast<int>(fit.points.size()) - num_checks;
  if (!fit.known_from_shape) return "no frame: " + fit.reason;
  std::string text =
      fmt::format("{} of {} used, {:.3g} mm rms", CountPoints(fit, PointState::kUsed), num_datum,
                  Distances(fit, {PointState::kUsed}).rms);
  if (num_checks > 0) {
    text +=
        fmt::format("; {} of {} checks passed", CountPoints(fit, PointState::kPassed), num_checks);
  }
  if (const ComparedPoint* worst = WorstPoint(fit)) text += ", worst " + ShortText(*worst);
  if (fit.ContradictsScale()) {
    text += "; the points require a change of " + ScaleChangeText(*fit.scale_change) + " in size";
  }
  return text;
}

std::vector<std::string> KnownPointWarnings(const KnownPointFit& fit) {
  std::vector<std::string> warnings;
  if (fit.points.empty()) return warnings;
  if (!fit.known_from_shape) {
    warnings.push_back("the known points give no frame and no checks: " + fit.reason);
  }
  for (const ComparedPoint& point : fit.points) {
    if (point.state == PointState::kFailed) {
      warnings.push_back(fmt::format(
          "check point {} is {:.1f} mm ({:.1f} sigmas) from its measured position; find out "
          "whether the measurement or the shape is wrong before using the shape",
          NameOf(point), kMmPerM * point.difference_m.norm(), point.sigmas_off));
    } else if (point.state == PointState::kLeftOut) {
      warnings.push_back(fmt::format(
          "known point {} is {:.1f} mm from where the others put it, {:.1f} sigmas: it is left "
          "out; check its coordinates, id and corner",
          NameOf(point), kMmPerM * point.difference_m.norm(), point.sigmas_off));
    }
  }
  if (fit.ContradictsScale()) {
    warnings.push_back(fmt::format(
        "the known points require a change of {} in the size of the shape; check marker_length, or "
        "measure a distance (distances, use: scale)",
        ScaleChangeText(*fit.scale_change)));
  }
  return warnings;
}

}  // namespace velamap
