#include "exporters/freeform/freeform_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "exporters/freeform/marker_front.h"
#include "exporters/freeform/mesh_integrals.h"
#include "exporters/freeform/mesh_refinement.h"
#include "exporters/freeform/surface_field.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

// kTrianglesPerArea * area / L^2 equilateral triangles of side L cover an area (the exact factor is
// 4 / sqrt(3)). No mesh with edges of at most L has fewer triangles.
constexpr double kTrianglesPerArea = 2.3;

SurfaceField MakeField(const std::vector<FreeformMarker>& markers) {
  std::vector<FieldPoint> points;
  std::vector<FieldNormal> normals;
  for (const FreeformMarker& marker : markers) {
    const auto& x = marker.corners_in_shape_m;
    for (std::size_t i = 0; i < x.size(); ++i) points.push_back({x[i], marker.sigmas_m[i]});
    normals.push_back({(x[0] + x[1] + x[2] + x[3]) / 4, marker.normal});
  }
  return {points, normals};
}

SurfacePoint PointNear(const SurfaceField& field, const Eigen::Vector3d& x_in_shape_m,
                       double reach_m) {
  const auto x = field.Project(x_in_shape_m, reach_m);
  if (!x) {
    throw DataError(
        "the markers contradict one another, or bend too sharply between their places; check them, "
        "and make each face of a body with edges a part of its own");
  }
  return {*x, field.Evaluate(*x).gradient.normalized()};
}

// The corners projected onto the surface, with the normals of the surface there.
std::vector<FrontMarker> MoveToSurface(const std::vector<FreeformMarker>& markers,
                                       const SurfaceField& field) {
  std::vector<FrontMarker> moved(markers.size());
  for (std::size_t k = 0; k < markers.size(); ++k) {
    const auto& x = markers[k].corners_in_shape_m;
    const double reach_m = (x[2] - x[0]).norm();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const SurfacePoint point = PointNear(field, x[i], reach_m);
      moved[k].corners_in_shape_m[i] = point.x_in_shape_m;
      moved[k].normals[i] = point.normal;
    }
  }
  return moved;
}

std::vector<FreeformMarker> LargestPiece(const std::vector<FreeformMarker>& markers,
                                         const std::vector<int>& pieces) {
  std::map<int, std::vector<FreeformMarker>> by_piece;
  for (std::size_t k = 0; k < markers.size(); ++k) {
    by_piece[pieces[kNumCorners * k]].push_back(markers[k]);
  }
  return std::max_element(
             by_piece.begin(), by_piece.end(),
             [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); })
      ->second;
}

EdgeMeasure ByLength(double length_m) {
  return [length_m](const TriangleMesh& mesh, int a, int b) {
    return (mesh.vertices_m[b] - mesh.vertices_m[a]).norm() / length_m;
  };
}

// An arc of length l whose normals turn by w has a sagitta of l w / 8. The middle of a triangle is
// up to 4/3 times as far from the surface as the middles of its sides. The square root makes the
// measure proportional to the length of the edge.
EdgeMeasure ByDeviation(double deviation_m) {
  return [deviation_m](const TriangleMesh& mesh, int a, int b) {
    const Eigen::Vector3d edge = mesh.vertices_m[b] - mesh.vertices_m[a];
    const double turn = std::abs((mesh.normals[b] - mesh.normals[a]).dot(edge.normalized()));
    return std::sqrt(edge.norm() * turn / 6 / deviation_m);
  };
}

[[noreturn]] void RefuseMesh(const MeshOptions& options, double least_edge_m) {
  if (options.edge_length_mm) {
    throw InputError(
        fmt::format("{}: {:.3g} mm would need more than {} triangles on a surface "
                    "without lines; give {:.2g} mm or more",
                    OptionName(&MeshOptions::edge_length_mm), *options.edge_length_mm,
                    kMaxFreeformTriangles, kMmPerM * least_edge_m));
  }
  throw InputError(fmt::format(
      "{}: {:.3g} mm would need more than {} triangles on a surface without lines; give "
      "more",
      OptionName(&MeshOptions::chord_deviation_mm), *options.chord_deviation_mm,
      kMaxFreeformTriangles));
}

// First divides the triangles until the sigma, which is largest between the markers, is nearly
// linear on each triangle, and evaluates it. Then divides them further to the wanted edges,
// interpolating the sigma.
TriangleMesh Refine(TriangleMesh coarse, const SurfaceField& field, double marker_length_m,
                    const std::optional<MeshOptions>& options, int num_threads) {
  constexpr double kSigmaTriangles = 2000, kEnoughTriangles = 1e5;
  const double area_m2 = AreaOf(coarse);
  const auto length_for = [area_m2](double num_triangles) {
    return std::sqrt(kTrianglesPerArea * area_m2 / num_triangles);
  };
  const NearSurface near_surface = [&field](const Eigen::Vector3d& x, double reach_m) {
    return PointNear(field, x, reach_m);
  };
  TriangleMesh mesh = RefineMesh(std::move(coarse), ByLength(length_for(kSigmaTriangles)),
                                 near_surface, kMaxFreeformTriangles, num_threads);
  mesh.sigmas_m = field.Sigmas(mesh.vertices_m, num_threads);
  EdgeMeasure measure = ByLength(std::max(marker_length_m / 2, length_for(kEnoughTriangles)));
  // The factor of 2 is a margin: most triangles are smaller than the edge length allows.
  const double least_edge_m = 2 * length_for(kMaxFreeformTriangles);
  if (options && options->edge_length_mm) {
    const double edge_m = kMPerMm * *options->edge_length_mm;
    if (edge_m < length_for(kMaxFreeformTriangles)) RefuseMesh(*options, least_edge_m);
    measure = ByLength(edge_m);
  }
  if (options && options->chord_deviation_mm) {
    measure = ByDeviation(kMPerMm * *options->chord_deviation_mm);
  }
  if (options && EstimateNumTriangles(mesh, measure) > 4.0 * kMaxFreeformTriangles) {
    RefuseMesh(*options, least_edge_m);
  }
  try {
    mesh = RefineMesh(std::move(mesh), measure, near_surface, kMaxFreeformTriangles, num_threads);
  } catch (const DataError& error) {
    if (!options || !options->chord_deviation_mm) throw;
    throw InputError(fmt::format("{}: {:.3g} mm cannot be reached on a surface without lines: {}",
                                 OptionName(&MeshOptions::chord_deviation_mm),
                                 *options->chord_deviation_mm, error.what()));
  }
  if (mesh.triangles.size() > kMaxFreeformTriangles) {
    if (options) RefuseMesh(*options, least_edge_m);
    throw DataError(
        "the surface folds between the markers; check them, and make each face of a body with "
        "edges a part of its own");
  }
  return mesh;
}

std::vector<FreeformResidual> Residuals(const std::vector<FreeformMarker>& markers,
                                        const std::vector<FrontMarker>& moved,
                                        const SurfaceField& field, int num_threads) {
  std::vector<Eigen::Vector3d> feet;
  std::vector<FreeformResidual> residuals;
  for (std::size_t k = 0; k < markers.size(); ++k) {
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      feet.push_back(moved[k].corners_in_shape_m[i]);
      const double distance_m =
          moved[k].normals[i].dot(markers[k].corners_in_shape_m[i] - feet.back());
      residuals.push_back({markers[k].marker_id, static_cast<int>(i) + 1, distance_m,
                           field.PointSigma(kNumCorners * k + i), 0.0});
    }
  }
  const std::vector<double> sigmas_m = field.Sigmas(feet, num_threads);
  for (std::size_t i = 0; i < feet.size(); ++i) residuals[i].surface_sigma_m = sigmas_m[i];
  return residuals;
}

// Adds a note that lists the markers with a corner far off the surface.
void NoteOutliers(const std::vector<FreeformMarker>& markers, FreeformSurface* surface) {
  constexpr double kMaxSigmas = 4.0;
  std::set<int> ids;
  for (std::size_t i = 0; i < surface->residuals.size(); ++i) {
    const FreeformResidual& residual = surface->residuals[i];
    const bool has_sigma = markers[i / kNumCorners].sigmas_m[i % kNumCorners].has_value();
    if (has_sigma && std::abs(residual.distance_m) > kMaxSigmas * residual.sigma_m) {
      ids.insert(residual.marker_id);
    }
  }
  if (ids.empty()) return;
  surface->notes.push_back(
      fmt::format("markers with a corner more than {} sigmas off the surface: {}", kMaxSigmas,
                  fmt::join(ids, ", ")));
}

void CheckCount(std::size_t num_markers) {
  if (num_markers >= kMinFreeformMarkers && num_markers <= kMaxFreeformMarkers) return;
  throw DataError(fmt::format("{} whole markers; {} to {} needed", num_markers, kMinFreeformMarkers,
                              kMaxFreeformMarkers));
}

// Returns the markers of the largest connected piece and adds a note on the others. Throws
// DataError if the piece has fewer than half of the markers or fewer than kMinFreeformMarkers.
std::vector<FreeformMarker> ConnectedMarkers(const std::vector<FreeformMarker>& markers,
                                             const std::vector<int>& pieces,
                                             std::vector<std::string>* notes) {
  const std::vector<FreeformMarker> connected = LargestPiece(markers, pieces);
  if (2 * connected.size() < markers.size() || connected.size() < kMinFreeformMarkers) {
    throw DataError(fmt::format(
        "only {} of {} markers are connected; the others are too far away from them or face "
        "another direction: make each face or body a part of its own in the layout",
        connected.size(), markers.size()));
  }
  std::set<int> left_out;
  for (const FreeformMarker& marker : markers) left_out.insert(marker.marker_id);
  for (const FreeformMarker& marker : connected) left_out.erase(marker.marker_id);
  notes->push_back(fmt::format("markers that stand apart from the others and are left out: {}",
                               fmt::join(left_out, ", ")));
  return connected;
}

}  // namespace

FreeformMarker MakeFreeformMarker(const ShapeMarker& marker,
                                  const PointCovariance* own_covariance) {
  FreeformMarker result;
  result.marker_id = marker.marker_id;
  result.normal = MarkerNormal(marker);
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    const auto idx = static_cast<std::size_t>(corner - 1);
    result.corners_in_shape_m[idx] = *marker.x_in_shape_m[corner];
    PointGradient along_normal;
    AddPointGradient(marker.marker_id, corner, result.normal, &along_normal);
    result.sigmas_m[idx] = SigmaOf(own_covariance, along_normal);
    if (!result.sigmas_m[idx] && marker.sigma_m[corner]) {
      result.sigmas_m[idx] = marker.sigma_m[corner]->cwiseProduct(result.normal).norm();
    }
  }
  return result;
}

FreeformSurface FitFreeformSurface(const std::vector<FreeformMarker>& markers,
                                   double marker_length_m,
                                   const std::optional<MeshOptions>& options, int num_threads) {
  CheckCount(markers.size());
  const SurfaceField field = MakeField(markers);
  const std::vector<FrontMarker> moved = MoveToSurface(markers, field);
  TriangleMesh mesh;
  mesh.triangles = JoinMarkers(moved);
  const std::vector<int> pieces = PieceOfVertex(mesh.triangles, kNumCorners * markers.size());
  FreeformSurface surface;
  if (std::set<int>(pieces.begin(), pieces.end()).size() > 1) {
    std::vector<std::string> notes;
    surface = FitFreeformSurface(ConnectedMarkers(markers, pieces, &notes), marker_length_m,
                                 options, num_threads);
    surface.notes.insert(surface.notes.begin(), notes.begin(), notes.end());
    return surface;
  }
  for (const FrontMarker& marker : moved) {
    const auto& x = marker.corners_in_shape_m;
    mesh.vertices_m.insert(mesh.vertices_m.end(), x.begin(), x.end());
    mesh.normals.insert(mesh.normals.end(), marker.normals.begin(), marker.normals.end());
  }
  const bool is_closed = CountOpenEdges(mesh.triangles) == 0;
  surface.mesh = Refine(std::move(mesh), field, marker_length_m, options, num_threads);
  surface.area_m2 = AreaOf(surface.mesh);
  if (is_closed) surface.volume_m3 = VolumeOf(surface.mesh);
  surface.rms_sigma_m = RmsSigma(surface.mesh);
  surface.residuals = Residuals(markers, moved, field, num_threads);
  std::vector<double> distances_m;
  for (const FreeformResidual& residual : surface.residuals)
    distances_m.push_back(residual.distance_m);
  surface.distance_m = ComputeStatistics(distances_m);
  NoteOutliers(markers, &surface);
  return surface;
}

}  // namespace velamap
