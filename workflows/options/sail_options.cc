#include "workflows/options/sail_options.h"

#include "exporters/sail/surface_csv.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

OptionGroup DescribeOptions(SailOptionTexts* texts) {
  return {"Surface",
          {{"Surface.edge_length", &texts->edge_length_mm, "mm",
            "longest edge of the mesh; left out: half a marker's side", MoreThan(0)},
           {"Surface.chord_deviation", &texts->chord_deviation_mm, "mm",
            "instead: how far the mesh may be from the surface", MoreThan(0)},
           {"Surface.edges_path", &texts->edges_path, "path",
            "CSV edge,x,y,z of points on luff, leech, foot or head that the surface goes on to; m, "
            "in the frame of the result"}}};
}

}  // namespace

std::vector<OptionGroup> SailGroups(ShapeExporterOptions* exporter, SailOptionTexts* texts) {
  const auto set_frame = [exporter](const std::string& text, const std::string& option) {
    exporter->frame = ParseFrameChoice(text, option);
  };
  const Option frame = {"frame", ParsedValue{&exporter->frame, "", set_frame}, "name|ids",
                        "reference_part, lines, camera, or the ids of origin, axis and plane "
                        "marker such as 12,15,40; "
                        "left out: as the layout says, else the first of these that can be made"};
  OptionGroup surface = DescribeOptions(texts);
  for (const Option& option : DescribeOptions(&exporter->sail.surface).options) {
    surface.options.push_back(option);
  }
  return {{"Frame of the result", {frame}}, DescribeOptions(&exporter->sail.sections), surface};
}

void CompleteSailOptions(const SailOptionTexts& texts, ShapeExporterOptions* exporter) {
  if (texts.edge_length_mm && texts.chord_deviation_mm) {
    throw InputError(
        "--Surface.chord_deviation: goes without --Surface.edge_length; give one of the two");
  }
  if (texts.edge_length_mm || texts.chord_deviation_mm) {
    exporter->sail.mesh = MeshOptions{texts.edge_length_mm, texts.chord_deviation_mm};
  }
  if (!texts.edges_path.empty()) {
    exporter->sail.surface.edges = ReadSurfaceEdges(texts.edges_path);
  }
  exporter->sail.Check();
}

}  // namespace velamap
