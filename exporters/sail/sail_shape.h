// What the layout's lines make of a shape: sections, and a smooth surface through each part that
// has horizontal lines.

#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "exporters/formats/mesh_triangles.h"
#include "exporters/sail/section.h"
#include "exporters/sail/surface.h"
#include "exporters/shape/marker_shape.h"
#include "exporters/shape/shape_frame.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct SailOptions {
  SectionOptions sections;
  SurfaceOptions surface;
  // Nothing: edges of half a marker's side, longer where that would be more than 100 000 triangles.
  std::optional<MeshOptions> mesh;

  void Check() const;  // throws InputError as those of its members do
};

struct SailSurface {
  std::string part;
  FittedSurface fit;
  TriangleMesh mesh;
  double area_m2 = 0.0;
};

struct SailShape {
  SectionReport sections;
  std::vector<SailSurface> surfaces;  // by part in the layout's order
  // One line each: a part whose markers bear no surface and why, and what odd things its fit met.
  std::vector<std::string> surface_notes;
};

// `shape` and `covariance` (null: none) are in `frame`. For a layout without horizontal lines
// there is no more than a note of the sections that says so. Throws InputError for bad options,
// such as a mesh of millions of triangles.
SailShape ComputeSail(const MarkerShape& shape, const ShapeFrame& frame, const Layout& layout,
                      const PointCovariance* covariance, const SailOptions& options);

// Writes the tables and drawings of the sections (sections.*, section_profiles.*) and, for each
// surface, surface.step .igs .ply .obj .stl and surface_residuals.csv; those of a second part have
// names with _2. `folder` has to be there. Throws InputError where it cannot be written.
void WriteSailFiles(const SailShape& sail, const ShapeFrame& frame,
                    const std::filesystem::path& folder);

// All names that WriteSailFiles() may use.
std::set<std::string> SailFileNames();

}  // namespace velamap
