#include "exporters/compare/shape_deviation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "exporters/compare/comparison_sigma.h"
#include "exporters/compare/mesh_fit.h"
#include "exporters/design/marker_distance.h"
#include "exporters/shape/shape_metrics.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

MarkerShape Aligned(const Rigid3& reference_from_shape, MarkerShape shape) {
  for (ShapeMarker& marker : shape.markers) {
    for (auto& sigma_m : marker.sigma_m) {
      if (sigma_m) sigma_m->setConstant(SigmaOfCoordinate(*sigma_m));
    }
    for (auto& x : marker.x_in_shape_m) {
      if (x) x = reference_from_shape * *x;
    }
  }
  return shape;
}

std::string PartOf(const ShapeMarker& marker, const Layout& layout) {
  return layout.HasMarkers() ? PartOfMarker(layout, marker.marker_id) : marker.part;
}

MarkerShape Keep(const MarkerShape& shape, const std::function<bool(const ShapeMarker&)>& keep) {
  MarkerShape kept;
  std::copy_if(shape.markers.begin(), shape.markers.end(), std::back_inserter(kept.markers), keep);
  return kept;
}

MarkerShape OnPart(const MarkerShape& shape, const Layout& layout, const std::string& part) {
  return part.empty() ? shape : MarkersOnPart(shape, layout, part);
}

// The deviation of a marker that has not been compared yet.
MarkerDeviation DeviationOf(const ShapeMarker& marker, const Layout& layout) {
  MarkerDeviation deviation;
  deviation.marker_id = marker.marker_id;
  deviation.part = PartOf(marker, layout);
  deviation.x_in_reference_m = *marker.x_in_shape_m[0];
  return deviation;
}

// `surface_sigma_m` is 0 for a shape as the reference, whose noise is in the covariance.
void SetSigma(const std::optional<Eigen::Matrix3d>& covariance_m2, double surface_sigma_m,
              MarkerDeviation* marker) {
  if (!covariance_m2) return;
  const double variance = marker->normal.dot(*covariance_m2 * marker->normal);
  marker->sigma_m = std::hypot(std::sqrt(std::max(0.0, variance)), surface_sigma_m);
  if (*marker->sigma_m > 0) marker->significance = marker->distance_m / *marker->sigma_m;
  if (marker->difference_m) {
    marker->difference_sigma_m = covariance_m2->diagonal().cwiseMax(0.0).cwiseSqrt();
  }
}

bool IsSignificant(const MarkerDeviation& marker) {
  return marker.significance && std::abs(*marker.significance) > kSignificantSigmas;
}

DeviationGroup MakeGroup(const std::string& part, const std::string& line,
                         const std::vector<const MarkerDeviation*>& markers) {
  DeviationGroup group{part, line, {}, 0};
  std::vector<double> distances_m;
  for (const MarkerDeviation* marker : markers) {
    if (!marker->is_over_surface) continue;
    distances_m.push_back(marker->distance_m);
    group.num_significant += IsSignificant(*marker) ? 1 : 0;
  }
  group.distance_m = ComputeStatistics(std::move(distances_m));
  return group;
}

void AddGroups(const Layout& layout, ShapeDeviation* deviation) {
  std::map<std::string, std::vector<const MarkerDeviation*>> parts;
  std::map<int, const MarkerDeviation*> by_id;
  for (const MarkerDeviation& marker : deviation->markers) {
    parts[marker.part].push_back(&marker);
    by_id[marker.marker_id] = &marker;
  }
  for (const auto& [part, markers] : parts) {
    deviation->parts.push_back(MakeGroup(part, "", markers));
  }
  for (const LayoutPart& part : layout.parts) {
    for (const auto* lines : {&part.horizontal, &part.vertical}) {
      for (const MarkerLine& line : *lines) {
        std::vector<const MarkerDeviation*> markers;
        for (const int id : line.marker_ids) {
          if (by_id.count(id) > 0) markers.push_back(by_id[id]);
        }
        if (!markers.empty()) deviation->lines.push_back(MakeGroup(part.name, line.name, markers));
      }
    }
  }
}

void Summarize(const Layout& layout, ShapeDeviation* deviation) {
  std::vector<double> distances_m, lengths_m;
  for (const MarkerDeviation& marker : deviation->markers) {
    if (!marker.is_over_surface) {
      ++deviation->num_beside;
      continue;
    }
    distances_m.push_back(marker.distance_m);
    if (marker.difference_m) lengths_m.push_back(marker.difference_m->norm());
    deviation->num_with_sigma += marker.sigma_m ? 1 : 0;
    deviation->num_significant += IsSignificant(marker) ? 1 : 0;
  }
  deviation->distance_m = ComputeStatistics(std::move(distances_m));
  deviation->difference_m = ComputeStatistics(std::move(lengths_m));
  AddGroups(layout, deviation);
}

double ScaleOf(const Alignment& alignment, const MarkerShape& shape, const MarkerShape& reference) {
  std::set<int> ids;
  for (const AlignmentEquation& equation : alignment.equations)
    ids.insert(equation.corner.marker_id);
  const auto counts = [&](const ShapeMarker& marker) {
    return ids.empty() || ids.count(marker.marker_id) > 0;
  };
  return ComputeReferenceMetrics(Keep(shape, counts), Keep(reference, counts)).scale;
}

// How far a marker may lie beyond the edge, m.
double ReachOf(const MeshFoot& foot, const Eigen::Vector3d& x_m,
               const std::optional<Eigen::Matrix3d>& covariance_m2, const EdgeOptions& edge) {
  double reach_m = kMPerMm * edge.tolerance_mm;
  const Eigen::Vector3d from_foot = x_m - foot.x_m;
  const Eigen::Vector3d across = from_foot - from_foot.dot(foot.normal) * foot.normal;
  if (covariance_m2 && across.norm() > 0) {
    const Eigen::Vector3d direction = across.normalized();
    const double variance_m2 = direction.dot(*covariance_m2 * direction);
    reach_m = std::max(reach_m, edge.num_sigmas * std::sqrt(std::max(0.0, variance_m2)));
  }
  return reach_m;
}

// How far the marker nearest to the surface lies beside it, m; 0 without markers.
double LeastBeside(const std::vector<MarkerDeviation>& markers) {
  const auto nearest =
      std::min_element(markers.begin(), markers.end(),
                       [](const auto& a, const auto& b) { return a.beside_m < b.beside_m; });
  return nearest == markers.end() ? 0.0 : nearest->beside_m;
}

// Diagonal of the bounding box of all corners, m.
double DiagonalOf(const MarkerShape& shape) {
  Eigen::AlignedBox3d box;
  for (const ShapeMarker& marker : shape.markers) {
    for (const auto& x : marker.x_in_shape_m) {
      if (x) box.extend(*x);
    }
  }
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

}  // namespace

std::vector<int> MarkersBeside(const ShapeDeviation& deviation) {
  std::vector<int> ids;
  for (const MarkerDeviation& marker : deviation.markers) {
    if (!marker.is_over_surface) ids.push_back(marker.marker_id);
  }
  return ids;
}

MarkerShape MarkersOnPart(const MarkerShape& shape, const Layout& layout, const std::string& part) {
  MarkerShape kept =
      Keep(shape, [&](const ShapeMarker& marker) { return PartOf(marker, layout) == part; });
  if (!kept.markers.empty()) return kept;
  std::set<std::string> parts;
  for (const ShapeMarker& marker : shape.markers) parts.insert(PartOf(marker, layout));
  throw InputError(fmt::format("--part: no marker of part '{}' was reconstructed; there are: {}",
                               part, fmt::join(parts, ", ")));
}

ShapeDeviation CompareWithShape(const UncertainShape& shape, const UncertainShape& reference,
                                const Layout& layout, const AlignmentOptions& options,
                                const std::string& part) {
  ShapeDeviation deviation;
  deviation.alignment = AlignShapes(shape.shape, reference.shape, layout, options);
  const AlignmentSensitivity sensitivity(deviation.alignment);
  const AlignedNoise noise(sensitivity, ComparedShape::kShape, shape.covariance),
      noise_of_reference(sensitivity, ComparedShape::kReference, reference.covariance);
  deviation.aligned_shape =
      Aligned(deviation.alignment.reference_from_shape, OnPart(shape.shape, layout, part));
  for (const ShapeMarker& marker : deviation.aligned_shape.markers) {
    if (!marker.IsWhole()) continue;
    const ShapeMarker* other = FindWholeMarker(reference.shape, marker.marker_id);
    if (other == nullptr) {
      deviation.only_in_shape.push_back(marker.marker_id);
      continue;
    }
    MarkerDeviation result = DeviationOf(marker, layout);
    result.normal = MarkerNormal(*other);
    result.difference_m = *marker.x_in_shape_m[0] - *other->x_in_shape_m[0];
    result.distance_m = result.normal.dot(*result.difference_m);
    SetSigma(DifferenceCovariance({marker.marker_id, result.x_in_reference_m}, noise,
                                  &noise_of_reference),
             0.0, &result);
    deviation.markers.push_back(std::move(result));
  }
  for (const ShapeMarker& marker : reference.shape.markers) {
    const bool is_of_part = part.empty() || PartOf(marker, layout) == part;
    if (is_of_part && marker.IsWhole() &&
        FindWholeMarker(shape.shape, marker.marker_id) == nullptr) {
      deviation.only_in_reference.push_back(marker.marker_id);
    }
  }
  if (deviation.markers.empty()) {
    throw DataError(
        "the shape and its reference have no whole marker in common; check that both have the same "
        "layout");
  }
  deviation.scale = ScaleOf(deviation.alignment, shape.shape, reference.shape);
  if (const auto likeness = MeasureLikeness(shape.shape, reference.shape, layout)) {
    deviation.doubt = DoubtOf(*likeness);
  }
  Summarize(layout, &deviation);
  return deviation;
}

ShapeDeviation CompareWithMesh(const UncertainShape& shape, const MeshDistance& mesh,
                               const Layout& layout, const AlignmentOptions& options,
                               const std::string& part, const EdgeOptions& edge,
                               double surface_sigma_m) {
  edge.Check();
  ShapeDeviation deviation;
  deviation.surface_sigma_m = surface_sigma_m;
  const MarkerShape compared = OnPart(shape.shape, layout, part);
  deviation.alignment = AlignToMesh(compared, mesh, options);
  const AlignmentSensitivity sensitivity(deviation.alignment);
  const AlignedNoise noise(sensitivity, ComparedShape::kShape, shape.covariance);
  deviation.aligned_shape = Aligned(deviation.alignment.reference_from_shape, compared);
  for (const ShapeMarker& marker : deviation.aligned_shape.markers) {
    if (!marker.IsWhole()) continue;
    const MeshFoot foot = ProjectMarker(mesh, marker);
    MarkerDeviation result = DeviationOf(marker, layout);
    result.normal = foot.normal;
    result.distance_m = foot.distance_m;
    result.beside_m = foot.beside_m;
    const auto covariance_m2 =
        DifferenceCovariance({marker.marker_id, result.x_in_reference_m}, noise, nullptr);
    const double reach_m = ReachOf(foot, result.x_in_reference_m, covariance_m2, edge);
    result.is_over_surface = foot.IsWithin(reach_m, mesh.Diagonal_m());
    if (result.is_over_surface && !foot.IsOverSurface(mesh.Diagonal_m())) {
      ++deviation.num_beyond_edge;
    }
    SetSigma(covariance_m2, surface_sigma_m, &result);
    deviation.markers.push_back(std::move(result));
  }
  Summarize(layout, &deviation);
  if (deviation.distance_m.count == 0) {
    throw DataError(fmt::format(
        "none of the {} whole markers lies over the surface of the reference (at least {:.0f} mm "
        "beside it); align them (--align best_fit) or give the surface of the same part",
        deviation.markers.size(), kMmPerM * LeastBeside(deviation.markers)));
  }
  if (deviation.alignment.method == AlignmentMethod::kBestFit) {
    deviation.doubt =
        DoubtOfSurfaceFit(compared, deviation.distance_m.rms, deviation.distance_m.count,
                          static_cast<int>(deviation.markers.size()));
  }
  return deviation;
}

std::optional<double> UnitHint(const MarkerShape& shape, const MeshDistance& mesh) {
  constexpr double kMaxRatio = 100.0;
  const double ratio = DiagonalOf(shape) / mesh.Diagonal_m();
  if (ratio > kMaxRatio) return 1e3;
  if (ratio < 1 / kMaxRatio) return 1e-3;
  return std::nullopt;
}

}  // namespace velamap
