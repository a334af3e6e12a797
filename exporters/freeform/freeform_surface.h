// Fits a surface through markers that are on no known lines, for example on inflatables, tanks,
// wings, hulls or the faces of a cube. The surface is closed or ends at the outer corners of the
// markers.
//
// SurfaceField smooths the four corners of each marker, weighted by their sigmas; the normals of
// the markers tell which side is outside. JoinMarkers() joins the corners by triangles, and
// RefineMesh() divides these on the smooth surface. Edges of the body are rounded if the markers
// are not close to them, so each face of a body with edges should be a part of its own.

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/formats/mesh_triangles.h"
#include "exporters/shape/marker_shape.h"
#include "importer/base/ids.h"
#include "importer/base/statistics.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// The four corners and their sigmas along the normal of the marker. The sigmas leave out errors
// that all markers share, such as the error of the scale, because these do not bend the surface.
struct FreeformMarker {
  int marker_id = 0;
  std::array<Eigen::Vector3d, kNumCorners> corners_in_shape_m;
  std::array<std::optional<double>, kNumCorners> sigmas_m;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // outward
};

// The marker must have all four corners. `own_covariance` is the covariance without shared errors
// (WithoutSharedErrors() in shape_sigma.h) or null.
FreeformMarker MakeFreeformMarker(const ShapeMarker& marker, const PointCovariance* own_covariance);

struct FreeformResidual {
  int marker_id = 0;
  int corner = 0;                // 1..4
  double distance_m = 0.0;       // of the corner from the surface; positive outside
  double sigma_m = 0.0;          // of the corner, as used in the fit
  double surface_sigma_m = 0.0;  // of the surface at this corner
};

struct FreeformSurface {
  TriangleMesh mesh;  // with normals and sigmas
  double area_m2 = 0.0;
  std::optional<double> volume_m3;          // if the surface is closed
  std::vector<FreeformResidual> residuals;  // by marker id and corner
  Statistics distance_m;                    // of the residuals
  double rms_sigma_m = 0.0;                 // of the surface, over its area
  std::vector<std::string> notes;           // on markers that are left out or do not fit
};

constexpr std::size_t kMinFreeformMarkers = 4, kMaxFreeformMarkers = 1000;
constexpr std::size_t kMaxFreeformTriangles = 1'000'000;

// Unless `mesh` sets other limits, the edges of the mesh are at most half of `marker_length_m`
// long, or longer if equilateral triangles of that side would number more than 100 000. Markers
// that are not connected to most of the others are left out. Throws DataError for too few or too
// many markers, if fewer than half of them are connected because they are in distant groups or face
// different directions, and if they contradict one another. Throws InputError if `mesh` requires
// more than kMaxFreeformTriangles. The result does not depend on `num_threads` (0: one per core).
FreeformSurface FitFreeformSurface(const std::vector<FreeformMarker>& markers,
                                   double marker_length_m, const std::optional<MeshOptions>& mesh,
                                   int num_threads = 0);

}  // namespace velamap
