// A surface through markers that are on no known lines: of inflatables, tanks, wings, hulls, the
// faces of a cube. It ends at the outer corners of the markers, or closes.
//
// All four corners of each marker lie on the surface with their sigmas, and its outward normal says
// which side is out: SurfaceField smooths them. JoinMarkers() finds the triangles, and RefineMesh()
// divides them on the smooth surface. Edges sharper than the spacing of the markers are rounded, so
// each face of a body with edges should be a part of its own.

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

// Four corners in their order, and their sigmas along the normal of the marker. Errors that all
// markers share, such as the error of the scale, do not bend the surface and are left out.
struct FreeformMarker {
  int marker_id = 0;
  std::array<Eigen::Vector3d, kNumCorners> corners_in_shape_m;
  std::array<std::optional<double>, kNumCorners> sigmas_m;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

// The marker must be whole. `own_covariance` may be null (WithoutSharedErrors() in shape_sigma.h).
FreeformMarker MakeFreeformMarker(const ShapeMarker& marker, const PointCovariance* own_covariance);

struct FreeformResidual {
  int marker_id = 0;
  int corner = 0;                // 1..4
  double distance_m = 0.0;       // of the corner from the surface, along its outward normal
  double sigma_m = 0.0;          // of the corner, as the fit weighted it
  double surface_sigma_m = 0.0;  // of the surface there
};

struct FreeformSurface {
  TriangleMesh mesh;  // with normals and sigmas
  double area_m2 = 0.0;
  std::optional<double> volume_m3;          // if the surface closes
  std::vector<FreeformResidual> residuals;  // by marker id and corner
  Statistics distance_m;                    // of the residuals
  double rms_sigma_m = 0.0;                 // of the surface, over its area
  std::vector<std::string> notes;           // markers left out or off
};

constexpr std::size_t kMinFreeformMarkers = 4, kMaxFreeformMarkers = 1000;
constexpr std::size_t kMaxFreeformTriangles = 1'000'000;

// Edges of half of `marker_length_m`, or longer ones to stay below 100 000 triangles, unless `mesh`
// says otherwise. Markers that stand apart from most others are left out. Throws DataError for too
// few or too many markers, for markers that are in groups far from each other or look in different
// directions, and for markers that contradict one another; InputError for more than
// kMaxFreeformTriangles. `num_threads` 0: one per core; never changes the result.
FreeformSurface FitFreeformSurface(const std::vector<FreeformMarker>& markers,
                                   double marker_length_m, const std::optional<MeshOptions>& mesh,
                                   int num_threads = 0);

}  // namespace velamap
