#include "workflows/commands/compared_shapes.h"

#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "exporters/compare/comparison_sigma.h"
#include "exporters/compare/shape_likeness.h"
#include "exporters/formats/shape_csv.h"
#include "exporters/shape/shape_sigma.h"
#include "exporters/surface/surface_csv.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/base/statistics.h"
#include "importer/geometry/units.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "workflows/options/shared_options.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

// Whether the covariance belongs to the shape, by the sigmas of both.
bool BelongsTo(const PointCovariance& covariance, const MarkerShape& shape) {
  constexpr double kTolerance = 1e-3;
  for (const ShapeMarker& marker : shape.markers) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const auto idx = static_cast<std::size_t>(corner);
      if (!marker.x_in_shape_m[idx]) continue;
      const auto sigma_m = PointSigma(&covariance, marker.marker_id, corner);
      if (!sigma_m || !marker.sigma_m[idx] ||
          (*sigma_m - *marker.sigma_m[idx]).norm() > kTolerance * sigma_m->norm()) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

UncertainShape ReadUncertainShape(const std::string& path, const std::string& uncertainty_path,
                                  const std::string& option) {
  UncertainShape result;
  result.shape = ReadShapeCsv(ShapeFile(path));
  const fs::path folder =
      uncertainty_path.empty() ? ModelFolderOfShape(path) : fs::path(uncertainty_path);
  if (!uncertainty_path.empty() && !HasUncertainty(folder.string())) {
    throw InputError(
        fmt::format("{}: {} holds no {}; give the metric model of the shape: sparse/0 of its "
                    "workspace, or what --output_path of shape_exporter has named",
                    option, uncertainty_path, kUncertaintyFileName));
  }
  if (HasUncertainty(folder.string())) {
    const PointCovariance covariance = ReadUncertainty(folder.string()).points;
    if (BelongsTo(covariance, result.shape)) {
      LogInfo("{}: joint uncertainty from {}", path, folder.string());
      result.covariance = covariance;
      return result;
    }
    if (!uncertainty_path.empty()) {
      throw InputError(
          fmt::format("{}: the uncertainty in {} does not belong to {}: the sigmas differ", option,
                      uncertainty_path, path));
    }
    LogWarning(
        "{}: the sigmas of its points are used as if they were independent, because the joint "
        "uncertainty in {} is of another frame or run; export both with one command",
        path, folder.string());
  }
  result.covariance = CovarianceFromSigmas(result.shape);
  return result;
}

void CountAsExact(const std::string& path, UncertainShape* reference) {
  if (!reference->covariance.IsEmpty()) return;
  LogInfo("{}: has no sigmas, so it counts as exact", path);
  MarkerShape exact = reference->shape;
  for (ShapeMarker& marker : exact.markers) marker.sigma_m.fill(Eigen::Vector3d::Zero().eval());
  reference->covariance = CovarianceFromSigmas(exact);
}

void CheckMetres(const std::string& path, const MarkerShape& shape, const Layout& layout) {
  std::vector<double> sides_m, ratios;
  for (const ShapeMarker& marker : shape.markers) {
    if (!marker.IsWhole()) continue;
    sides_m.push_back(MeanSide(MarkerSides(marker)));
    if (layout.HasMarkers()) {
      ratios.push_back(sides_m.back() / MarkerLength(layout, marker.marker_id));
    }
  }
  if (!ratios.empty() && IsThousandfold(Median(ratios))) {
    throw InputError(
        fmt::format("{}: its markers are 1000 times as large as the layout says: give metres, not "
                    "millimetres",
                    path));
  }
  if (sides_m.empty() || Median(sides_m) <= kMaxMarkerLength_m) return;
  throw InputError(
      fmt::format("{}: its markers have sides of {:.3g} m, expected at most {:g} m: give metres, "
                  "not millimetres",
                  path, Median(sides_m), kMaxMarkerLength_m));
}

void CheckMetres(const std::string& path, const MarkerShape& shape,
                 const std::string& reference_path, const MarkerShape& reference,
                 const Layout& layout) {
  const auto likeness = MeasureLikeness(shape, reference, layout);
  if (likeness && !likeness->IsOfAnotherObject()) {
    const bool is_large = IsThousandfold(likeness->scale);
    if (is_large || IsThousandfold(1 / likeness->scale)) {
      throw InputError(fmt::format("{}: is 1000 times as large as {}: give metres, not millimetres",
                                   is_large ? path : reference_path,
                                   is_large ? reference_path : path));
    }
  }
  CheckMetres(path, shape, layout);
  CheckMetres(reference_path, reference, layout);
}

Option MeshUnitOption(const std::string& name, MeshReadOptions* options) {
  const auto set_unit = [options](const std::string& text, const std::string& option) {
    options->m_per_unit = MPerUnitFromName(text, option);
  };
  return {name, ParsedValue{&options->m_per_unit, "", set_unit}, "m|mm",
          "unit of a .ply, .stl or .obj; left out: as velamap wrote it, else m for .ply, mm for "
          ".stl and .obj"};
}

void CheckUnit(const std::string& path, const MeshReadOptions& options,
               const std::string& unit_option, const MarkerShape& shape, const MeshDistance& mesh) {
  const std::optional<double> factor = UnitHint(shape, mesh);
  if (!factor) return;
  const std::string what = fmt::format("{}: is {:.3g} m across, which does not match the shape",
                                       path, mesh.Diagonal_m());
  if (HasOwnUnit(path) || options.m_per_unit) {
    LogWarning("{}; is its unit right?", what);
    return;
  }
  const std::string other_unit = *factor > 1 ? "m" : "mm";
  const std::string unit = DefaultMPerUnit(path) == 1.0 ? "m" : "mm";
  const std::string remedy = other_unit == unit ? "check that it is a surface of the same object"
                                                : fmt::format("if its unit is {0}, give --{1} {0}",
                                                              other_unit, unit_option);
  throw InputError(fmt::format("{}; {}; if it is right as it is, give --{} {}", what, remedy,
                               unit_option, unit));
}

double SurfaceSigma(const std::string& path) {
  const std::string stem = fs::path(path).stem().string(), fitted = "surface";
  if (stem.compare(0, fitted.size(), fitted) != 0) return 0.0;
  const fs::path residuals =
      fs::path(path).parent_path() / (fitted + "_residuals" + stem.substr(fitted.size()) + ".csv");
  if (!IsRegularFile(residuals)) return 0.0;
  try {
    const double sigma_m = ReadSurfaceResidualRms(residuals.string());
    LogInfo("{}: known to {:.2g} mm, by {}", path, kMmPerM * sigma_m, residuals.string());
    return sigma_m;
  } catch (const InputError& error) {
    LogWarning("the surface counts as exact: {}", error.what());
    return 0.0;
  }
}

void CheckFaces(const std::string& path, const MeshDistance& mesh) {
  if (mesh.NumFlippedEdges() == 0) return;
  LogWarning(
      "{}: the triangles at {} edges face opposite sides, where the signs of distances are "
      "arbitrary",
      path, mesh.NumFlippedEdges());
}

}  // namespace velamap
