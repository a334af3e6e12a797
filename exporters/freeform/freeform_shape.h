// A surface through each part of a shape that has no lines, with its files.

#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "exporters/formats/length_unit.h"
#include "exporters/formats/mesh_triangles.h"
#include "exporters/freeform/freeform_surface.h"
#include "exporters/shape/marker_shape.h"
#include "exporters/shape/shape_frame.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct PartSurface {
  std::string part;       // empty for the markers of a layout without parts
  std::string file_stem;  // freeform, freeform_2, ...
  FreeformSurface surface;
};

struct FreeformShape {
  std::vector<PartSurface> surfaces;  // by part in the layout's order
  // One line per part of enough markers without a surface, with the reason, and one per group of
  // markers that a surface leaves out or misses.
  std::vector<std::string> notes;
  std::exception_ptr surface_error;  // as in SailShape
};

// What messages call the part: its name, or "all markers" where a layout without parts has none.
std::string ShownName(const std::string& part);

// "0.3139 m2", or "0.3139 m2, closed, 0.0214 m3".
std::string SizeText(const FreeformSurface& surface);

// Takes the parts without horizontal and vertical lines that name at least kMinFreeformMarkers
// markers; all markers for a layout without parts. `shape` and `covariance` (may be null) are in
// one frame. `mesh` is SailOptions::mesh. `num_threads` 0: one per core; never changes the result.
FreeformShape ComputeFreeform(const MarkerShape& shape, const Layout& layout,
                              const PointCovariance* covariance,
                              const std::optional<MeshOptions>& mesh, int num_threads = 0);

// Writes .ply .obj .stl of each surface under its stem, and freeform_residuals.csv with the corners
// of all of them. `unit` is the unit of OBJ and STL. `folder` has to exist. Throws InputError if it
// is not writable.
void WriteFreeformFiles(const FreeformShape& freeform, const ShapeFrame& frame, LengthUnit unit,
                        const std::filesystem::path& folder);

}  // namespace velamap
