#include "workflows/options/sail_options.h"

#include "exporters/formats/length_unit.h"
#include "exporters/surface/surface_csv.h"
#include "workflows/options/shared_options.h"

namespace velamap {
namespace {

OptionGroup SurfaceGroup(SurfaceOptions* options, SurfaceFileOptions* file_options) {
  OptionGroup group = DescribeOptions(options);
  for (const Option& option : DescribeOptions(&file_options->mesh).options) {
    group.options.push_back(option);
  }
  group.options.push_back(PathOption("Surface.edges_path", PathUse::kReadsFile,
                                     &file_options->edges_path,
                                     "CSV edge,x,y,z of points on luff, leech, foot or head to "
                                     "which the surface continues; m, in the frame of the result"));
  return group;
}

OptionGroup FileGroup(SailFileOptions* files) {
  OptionGroup group = DescribeOptions(&files->grid);
  group.title = "Files of the surface";
  group.options.push_back(ChoiceOption("unit", &files->unit, kLengthUnits,
                                       "unit of OBJ, STL, DXF, MSH and ANSYS files; CSV, PLY and "
                                       "VTS are in m, STEP and IGES name their unit"));
  return group;
}

}  // namespace

std::vector<OptionGroup> SailGroups(ShapeExporterOptions* exporter, SurfaceFileOptions* surface) {
  const auto set_frame = [exporter](const std::string& text, const std::string& option) {
    exporter->frame = ParseFrameChoice(text, option);
  };
  const Option frame =
      Common({"frame", ParsedValue{&exporter->frame, "", set_frame}, "name|ids",
              "known_points, reference_part, lines, camera, or the ids of origin, axis and plane "
              "marker such as 12,15,40; left out: as the layout says, else the first of these that "
              "can be made"});
  return {{"Frame and scale of the result", {frame, ScaleOption(&exporter->scale_by)}},
          DescribeOptions(&exporter->sail.sections),
          SurfaceGroup(&exporter->sail.surface, surface),
          FileGroup(&exporter->files)};
}

void CompleteSailOptions(const SurfaceFileOptions& surface, ShapeExporterOptions* exporter) {
  if (surface.mesh.edge_length_mm || surface.mesh.chord_deviation_mm) {
    exporter->sail.mesh = surface.mesh;
  }
  if (!surface.edges_path.empty()) {
    exporter->sail.surface.edges = ReadSurfaceEdges(surface.edges_path);
  }
  exporter->sail.Check();
  exporter->files.grid.Check();
}

}  // namespace velamap
