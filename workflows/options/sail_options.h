// Options of the frame, the sections and the surface of the shape.

#pragma once

#include <string>
#include <vector>

#include "exporters/formats/mesh_triangles.h"
#include "exporters/shape_exporter.h"
#include "workflows/options/option_parser.h"

namespace velamap {

// What CompleteSailOptions() turns into members of ShapeExporterOptions.
struct SurfaceFileOptions {
  MeshOptions mesh;  // none of its members given: as SailOptions decides
  std::string edges_path;
};

// --frame, --scale_by, --Section.*, --Surface.* and --unit, which set `exporter` and `surface`.
std::vector<OptionGroup> SailGroups(ShapeExporterOptions* exporter, SurfaceFileOptions* surface);

// Called once the options are set: reads the file of the edges and checks everything. Throws
// InputError that names the option or file.
void CompleteSailOptions(const SurfaceFileOptions& surface, ShapeExporterOptions* exporter);

}  // namespace velamap
