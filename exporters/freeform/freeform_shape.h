// Fits a surface through each part of a shape that has no horizontal lines, and writes its files.

#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "exporters/formats/length_unit.h"
#include "exporters/formats/mesh_triangles.h"
#include "exporters/formats/ply_writer.h"
#include "exporters/freeform/freeform_surface.h"
#include "exporters/shape/marker_shape.h"
#include "exporters/shape/shape_frame.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct PartSurface {
  std::string part;       // empty for a layout without parts
  std::string file_stem;  // freeform, freeform_2, ...
  FreeformSurface surface;
};

struct FreeformShape {
  std::vector<PartSurface> surfaces;  // in the order of the layout's parts
  // One line for each part that has enough markers but no surface, with the reason, and one for
  // each group of markers that a surface leaves out or does not fit.
  std::vector<std::string> notes;
  std::exception_ptr surface_error;  // as in SailShape
};

// The name of the part for messages. For a layout without parts it is "all markers".
std::string ShownName(const std::string& part);

// "0.3139 m2", or "0.3139 m2, closed, 0.0214 m3"; below 0.1 m2 in mm.
std::string SizeText(const FreeformSurface& surface);

// Fits the parts that have no horizontal lines and name at least kMinFreeformMarkers markers, on
// vertical lines or elsewhere. A layout without parts counts as one part with all markers. `shape`
// and `covariance` (may be null) are in the same frame. `mesh` is SailOptions::mesh. The result
// does not depend on `num_threads` (0: one per core).
FreeformShape ComputeFreeform(const MarkerShape& shape, const Layout& layout,
                              const PointCovariance* covariance,
                              const std::optional<MeshOptions>& mesh, int num_threads = 0);

// Writes each surface as PLY, OBJ and STL, named by its stem, and freeform_residuals.csv with the
// corners of all surfaces. `unit` is the unit of OBJ and STL. `folder` must exist. Throws
// InputError if a file cannot be written.
void WriteFreeformFiles(const FreeformShape& freeform, const ShapeFrame& frame, LengthUnit unit,
                        PlyFormat ply_format, const std::filesystem::path& folder);

}  // namespace velamap
