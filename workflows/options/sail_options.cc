#include "workflows/options/sail_options.h"

#include <sstream>

#include <fmt/format.h>

#include "exporters/sail/surface_csv.h"
#include "importer/base/error.h"
#include "importer/base/numbers.h"

namespace velamap {
namespace {

std::vector<double> HeightsFromText(const std::string& text) {
  std::vector<double> heights_m;
  std::istringstream stream(text);
  std::string item;
  while (std::getline(stream, item, ',')) {
    double height_m = 0.0;
    if (!ParseNumber(item, &height_m)) {
      throw InputError(
          fmt::format("--Section.heights: '{}' is no list of heights in m such as 1,2.5,4", text));
    }
    heights_m.push_back(height_m);
  }
  return heights_m;
}

}  // namespace

OptionGroup SailGroup(ShapeExporterOptions* exporter, SailOptionTexts* texts) {
  const ParsedValue frame = {"", [exporter](const std::string& text) {
                               exporter->frame = ParseFrameChoice(text, "--frame");
                             }};
  const ParsedValue heights = {"", [exporter](const std::string& text) {
                                 exporter->sail.sections.heights_m = HeightsFromText(text);
                               }};
  SurfaceOptions* surface = &exporter->sail.surface;
  return {"Frame, sections and surface of the result",
          {{"frame", frame, "name|ids",
            "reference_part, lines, camera, or the ids of origin, axis and plane marker such as "
            "12,15,40; left out: as the layout says, else the first of these that can be made"},
           {"Section.heights", heights, "m,m,...", "heights of more sections, z of the frame"},
           {"Section.min_markers", &exporter->sail.sections.min_markers, "markers",
            "fewest on a line that make a section"},
           {"Surface.edge_length", &texts->edge_length_mm, "mm",
            "longest edge of the mesh; left out: half a marker's side"},
           {"Surface.chord_deviation", &texts->chord_deviation_mm, "mm",
            "or how far the mesh may be from the surface"},
           {"Surface.luff_extension", &surface->luff_extension_m, "m",
            "how far the surface goes on beyond the first markers of the lines"},
           {"Surface.leech_extension", &surface->leech_extension_m, "m", "beyond the last ones"},
           {"Surface.foot_extension", &surface->foot_extension_m, "m", "below the lowest line"},
           {"Surface.head_extension", &surface->head_extension_m, "m", "above the highest line"},
           {"Surface.edges_path", &texts->edges_path, "path",
            "CSV edge,x,y,z of points on luff, leech, foot or head that it goes on to; m, in the "
            "frame of the result"}}};
}

void CompleteSailOptions(const SailOptionTexts& texts, ShapeExporterOptions* exporter) {
  if (texts.edge_length_mm || texts.chord_deviation_mm) {
    exporter->sail.mesh = MeshOptions{texts.edge_length_mm, texts.chord_deviation_mm};
  }
  if (!texts.edges_path.empty()) {
    exporter->sail.surface.edges = ReadSurfaceEdges(texts.edges_path);
  }
  exporter->sail.Check();
}

}  // namespace velamap
