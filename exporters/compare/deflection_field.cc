#include "exporters/compare/deflection_field.h"

#include <cmath>

#include <fmt/format.h>

#include "exporters/compare/comparison_sigma.h"
#include "exporters/surface/surface.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "importer/text/csv.h"

namespace velamap {
namespace {

// The noise of a surface that is compared, from the joint covariance of the markers that it was
// fitted to, so that it agrees with the sigmas of the markers themselves.
class SurfaceNoise {
 public:
  // `fit` belongs to the markers of the shape or of its reference (`whose`), in the frame of the
  // reference. `covariance` is that of its corners, in its own frame. Both must outlive this.
  SurfaceNoise(const FittedSurface& fit, ComparedShape whose,
               const AlignmentSensitivity& sensitivity, const PointCovariance& covariance)
      : fit_(fit), noise_(sensitivity, whose, covariance) {}

  // Variance of the surface at a place along a unit vector: from the noise of its markers, from the
  // effect of that noise on the alignment, and from smoothing (SurfaceDependence::VarianceWith).
  // Returns nothing if a sigma that it depends on is unknown, or if the surface interpolates.
  std::optional<double> VarianceAt(double u, double v, const Eigen::Vector3d& direction) const {
    const std::optional<SurfaceDependence> dependence = DependenceAt(fit_, u, v);
    if (!dependence) return std::nullopt;
    CornerGradient own;
    for (std::size_t k = 0; k < fit_.points.size(); ++k) {
      own[fit_.points[k]] = dependence->point_weights[static_cast<Eigen::Index>(k)] * direction;
    }
    const auto of_markers_m2 = noise_.VarianceAt(EvaluatePoint(fit_.surface, u, v), direction, own);
    if (!of_markers_m2) return std::nullopt;
    return dependence->VarianceWith(*of_markers_m2);
  }

 private:
  const FittedSurface& fit_;
  const AlignedNoise noise_;
};

std::optional<double> Sigma(const std::optional<double>& variance_m2,
                            const std::optional<double>& other_variance_m2) {
  if (!variance_m2 || !other_variance_m2) return std::nullopt;
  return std::sqrt(*variance_m2 + *other_variance_m2);
}

// The rounding of an alignment or of a fit, far below what anything can measure, is 0.
double WithoutRounding(double value_m) {
  constexpr double kRounding_m = 1e-9;
  return std::abs(value_m) < kRounding_m ? 0.0 : value_m;
}

Deflection MakeDeflection(const Eigen::Vector3d& vector_m, double distance_m,
                          const std::optional<double>& sigma_m) {
  return {vector_m.unaryExpr(&WithoutRounding), WithoutRounding(distance_m), sigma_m};
}

DeflectionField FieldBetween(const Alignment& alignment, const UncertainSurfaces& shape,
                             const UncertainSurfaces& reference, const LayoutPart& part,
                             const GridOptions& options) {
  const MarkerShape& markers = shape.surfaces.shape();
  const MarkerShape& markers_of_reference = reference.surfaces.shape();
  const FittedSurface& of_shape = shape.surfaces.OfCommon(part, markers_of_reference);
  const FittedSurface& of_reference = reference.surfaces.OfCommon(part, markers);
  const AlignmentSensitivity sensitivity(alignment);
  const SurfaceNoise noise(of_shape, ComparedShape::kShape, sensitivity, shape.covariance),
      noise_of_reference(of_reference, ComparedShape::kReference, sensitivity,
                         reference.covariance);
  DeflectionField field{part.name, MakeGrid(of_reference.surface, options), {}};
  if (!FacesLikeMarkers(of_reference, markers_of_reference)) {
    for (Eigen::Vector3d& normal : field.reference.normals) normal = -normal;
  }
  for (std::size_t i = 0; i < field.reference.vertices_m.size(); ++i) {
    const double u = field.reference.surface_parameters[i].x(),
                 v = field.reference.surface_parameters[i].y();
    const Eigen::Vector3d& normal = field.reference.normals[i];
    const Eigen::Vector3d vector_m =
        EvaluatePoint(of_shape.surface, u, v) - field.reference.vertices_m[i];
    field.deflections.push_back(MakeDeflection(
        vector_m, vector_m.dot(normal),
        Sigma(noise.VarianceAt(u, v, normal), noise_of_reference.VarianceAt(u, v, normal))));
  }
  return field;
}

// The grid of the shape's surface moved to the design.
DeflectionField FieldFrom(const MeshDistance& design, const ShapeDeviation& deviation,
                          const UncertainSurfaces& shape, const LayoutPart& part,
                          const GridOptions& options, const EdgeOptions& edge) {
  const double reach_m = kMPerMm * edge.tolerance_mm;
  const double design_variance_m2 = deviation.surface_sigma_m * deviation.surface_sigma_m;
  const FittedSurface& fit = shape.surfaces.Of(part);
  const AlignmentSensitivity sensitivity(deviation.alignment);
  const SurfaceNoise noise(fit, ComparedShape::kShape, sensitivity, shape.covariance);
  DeflectionField field{part.name, MakeGrid(fit.surface, options), {}};
  for (std::size_t i = 0; i < field.reference.vertices_m.size(); ++i) {
    const Eigen::Vector2d& at = field.reference.surface_parameters[i];
    const MeshFoot foot = design.Project(field.reference.vertices_m[i]);
    field.deflections.emplace_back();
    if (foot.IsWithin(reach_m, design.Diagonal_m())) {
      field.deflections.back() =
          MakeDeflection(foot.distance_m * foot.normal, foot.distance_m,
                         Sigma(noise.VarianceAt(at.x(), at.y(), foot.normal), design_variance_m2));
    }
    field.reference.vertices_m[i] -= foot.distance_m * foot.normal;
    field.reference.normals[i] = foot.normal;
  }
  return field;
}

template <typename Function>
DeflectionReport ForEachPart(const Layout& layout, const std::string& wanted_part,
                             const Function& make_field) {
  DeflectionReport report;
  for (const LayoutPart& part : layout.parts) {
    if (part.horizontal.empty() || (!wanted_part.empty() && part.name != wanted_part)) continue;
    try {
      report.fields.push_back(make_field(part));
    } catch (const DataError& error) {
      report.notes.push_back(fmt::format("{}: no deflections: {}", part.name, error.what()));
    }
  }
  return report;
}

}  // namespace

DeflectionReport ComputeDeflections(const Alignment& alignment, const UncertainSurfaces& shape,
                                    const UncertainSurfaces& reference, const Layout& layout,
                                    const GridOptions& grid, const std::string& part) {
  return ForEachPart(layout, part, [&](const LayoutPart& p) {
    return FieldBetween(alignment, shape, reference, p, grid);
  });
}

DeflectionReport ComputeDeflections(const ShapeDeviation& deviation, const UncertainSurfaces& shape,
                                    const MeshDistance& reference, const Layout& layout,
                                    const GridOptions& grid, const std::string& part,
                                    const EdgeOptions& edge) {
  return ForEachPart(layout, part, [&](const LayoutPart& p) {
    return FieldFrom(reference, deviation, shape, p, grid, edge);
  });
}

void WriteDeflectionCsv(const std::vector<NamedDeflections>& shapes, std::ostream& out) {
  CsvWriter csv(out);
  csv.WriteRecord("shape", "part", "section", "point", "u", "v", "x", "y", "z", "dx", "dy", "dz",
                  "distance", "sigma");
  for (const NamedDeflections& named : shapes) {
    for (const DeflectionField& field : named.report->fields) {
      for (std::size_t i = 0; i < field.deflections.size(); ++i) {
        const SurfaceGrid& grid = field.reference;
        const auto row = static_cast<int>(i);
        const Eigen::Vector3d& x = grid.vertices_m[i];
        const auto& deflection = field.deflections[i];
        const auto known = [&](double value) {
          return deflection ? std::optional<double>(value) : std::nullopt;
        };
        const Deflection d = deflection.value_or(Deflection{});
        csv.WriteRecord(named.shape, field.part, row / grid.num_points + 1,
                        row % grid.num_points + 1, grid.surface_parameters[i].x(),
                        grid.surface_parameters[i].y(), x.x(), x.y(), x.z(), known(d.vector_m.x()),
                        known(d.vector_m.y()), known(d.vector_m.z()), known(d.distance_m),
                        d.sigma_m);
      }
    }
  }
}

void WriteDeflectionVts(const DeflectionField& field, const std::string& name, std::ostream& out) {
  std::vector<Eigen::Vector3d> vectors_m;
  std::vector<double> distances_m, is_known, sigmas_m;
  for (const auto& deflection : field.deflections) {
    const Deflection d = deflection.value_or(Deflection{});
    vectors_m.push_back(d.vector_m);
    distances_m.push_back(d.distance_m);
    is_known.push_back(deflection ? 1.0 : 0.0);
    if (d.sigma_m) sigmas_m.push_back(*d.sigma_m);
  }
  GridData data{{{"deflection", vectors_m}}, {{"distance", distances_m}, {"is_known", is_known}}};
  if (sigmas_m.size() == field.deflections.size()) data.scalars.emplace_back("sigma", sigmas_m);
  WriteGridVts(field.reference, name, out, data);
}

}  // namespace velamap
