// Surfaces that libraries of Debian fill in through the corners of markers, beside those of
// exporters/freeform.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/freeform/freeform_surface.h"

namespace velamap {

// What a method is asked: how far its surface is from each of these places, along the normal.
struct FillingTask {
  const std::vector<FreeformMarker>& markers;
  const TriangleMesh& mesh;           // triangles that join and divide them, corners first
  const std::vector<bool>& is_given;  // by vertex: a corner of a marker, or on an open edge
  const std::vector<Eigen::Vector3d>& places_m;  // vertices of the mesh that are not on an edge
  const std::vector<Eigen::Vector3d>& normals;   // of the true surface there
};

// By place, m along the normal; nothing where the method has no surface.
using FillingOffsets = std::vector<std::optional<double>>;

struct FillingMethod {
  std::string name;
  bool can_close = true;  // surfaces that are no graph above a plane
  FillingOffsets (*offsets_m)(const FillingTask& task);
};

// Open CASCADE's plate, the engine of its filling of edges and points (BRepFill_Filling).
void AddOpenCascadeMethods(std::vector<FillingMethod>* methods);

// Poisson reconstruction and the fairing of a mesh. Only where CGAL was there at build time
// (VELAMAP_WITH_CGAL): nothing else of velamap needs it.
void AddCgalMethods(std::vector<FillingMethod>* methods);

}  // namespace velamap
