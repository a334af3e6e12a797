// Reads the shapes to compare, with their uncertainty, and checks the design.

#pragma once

#include <string>

#include "exporters/compare/shape_deviation.h"
#include "exporters/design/mesh_reader.h"
#include "workflows/options/option_parser.h"

namespace velamap {

// Reads a shape.csv, or the one in a folder, with the joint uncertainty of the model in
// `uncertainty_path` or, without it, in sparse/0 beside the folder of shape.csv; otherwise with the
// sigmas of the file, with a warning if the model there is another one. `option` is the name of the
// option that gives `uncertainty_path`, for messages. Throws InputError if the files cannot be read
// or do not belong to each other.
UncertainShape ReadUncertainShape(const std::string& path, const std::string& uncertainty_path,
                                  const std::string& option);

// Gives a reference without any sigma, such as a truth or a design by its markers, the uncertainty
// of exact points, so that a shape with sigmas tells which differences are significant.
void CountAsExact(const std::string& path, UncertainShape* reference);

// Throws InputError naming the file whose coordinates are millimetres instead of metres: by the
// length of its markers, which `layout` may know.
void CheckMetres(const std::string& path, const MarkerShape& shape, const Layout& layout);

// The same for two shapes, by their sizes: the one that is 1000 times as large is wrong.
void CheckMetres(const std::string& path, const MarkerShape& shape,
                 const std::string& reference_path, const MarkerShape& reference,
                 const Layout& layout);

// The unit of a .ply, .stl or .obj, as the option `name`.
Option MeshUnitOption(const std::string& name, MeshReadOptions* options);

// Throws InputError if the unit of the design in `path` cannot be right and was not given by
// `unit_option`; warns if it was.
void CheckUnit(const std::string& path, const MeshReadOptions& options,
               const std::string& unit_option, const MarkerShape& shape, const MeshDistance& mesh);

// 1 sigma (m) of the surface in `path`. For a surface that velamap fitted, such as surface.step, it
// is the root mean square of the surface_residuals.csv beside it, because even the markers of its
// own shape lie that far from it. 0 for any other surface.
double SurfaceSigma(const std::string& path);

// Warns of triangles that face opposite sides.
void CheckFaces(const std::string& path, const MeshDistance& mesh);

}  // namespace velamap
