// The sections of a shape at the lines of the layout, and a smooth surface through each part that
// has horizontal lines.

#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "exporters/formats/length_unit.h"
#include "exporters/formats/mesh_triangles.h"
#include "exporters/formats/ply_writer.h"
#include "exporters/formats/surface_grid.h"
#include "exporters/sail/section.h"
#include "exporters/shape/marker_shape.h"
#include "exporters/shape/shape_frame.h"
#include "exporters/surface/surface.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct SailOptions {
  SectionOptions sections;
  SurfaceOptions surface;
  // By default edges of half a marker's side, or longer ones to stay below 100 000 triangles.
  std::optional<MeshOptions> mesh;

  void Check() const;  // throws InputError as the checks of its members do
};

struct SailFileOptions {
  LengthUnit unit = LengthUnit::kMetre;  // of the formats that name none, and of DXF
  GridOptions grid;
  bool ascii_ply = false;
  PlyFormat Ply() const { return ascii_ply ? PlyFormat::kAscii : PlyFormat::kBinaryLittleEndian; }
};

struct SailSurface {
  std::string part;
  FittedSurface fit;
  TriangleMesh mesh;
  double area_m2 = 0.0;
  // Along the normal, over its area, with the errors that markers share; nothing without a
  // covariance or if the markers are interpolated.
  std::optional<double> rms_sigma_m;
};

struct SailShape {
  SectionReport sections;
  std::vector<SailSurface> surfaces;  // by part in the layout's order
  // One line per part without a surface, with the reason, and one per gap or outlier of a fit.
  std::vector<std::string> surface_notes;
  // The first error of a surface fit that the markers did not cause, such as an option that is out
  // of range for the size of the part; null if there is none.
  std::exception_ptr surface_error;
};

// `shape` and `covariance` (may be null) are in `frame`. A layout without horizontal lines gives a
// note and nothing else. Throws InputError for options that are bad whatever the shape.
SailShape ComputeSail(const MarkerShape& shape, const ShapeFrame& frame, const Layout& layout,
                      const PointCovariance* covariance, const SailOptions& options);

// Writes the tables and drawings of the sections (sections.*, section_profiles.*) and, for each
// surface, surface.step .igs .ply .obj .stl, its grid as .vts .msh and _ansys.txt, and
// surface_residuals.csv and surface_edges.csv. STEP and IGES have the sections and markers of the
// part beside the surface. The names of a second part end in _2. `folder` has to exist. Throws
// InputError if it is not writable.
void WriteSailFiles(const SailShape& sail, const MarkerShape& shape, const ShapeFrame& frame,
                    const SailFileOptions& options, const std::filesystem::path& folder);

}  // namespace velamap
