// Options of what is made of the shape: its frame, sections and surface.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/shape_exporter.h"
#include "workflows/options/option_parser.h"

namespace velamap {

// What becomes members of ShapeExporterOptions once the options are set.
struct SailOptionTexts {
  std::optional<double> edge_length_mm;
  std::optional<double> chord_deviation_mm;
  std::string edges_path;
};

// --frame, --Section.* and --Surface.*, which set `exporter` and `texts`.
std::vector<OptionGroup> SailGroups(ShapeExporterOptions* exporter, SailOptionTexts* texts);

// Once the options are set: reads the file of the edges and checks everything. Throws InputError
// that names the option or file.
void CompleteSailOptions(const SailOptionTexts& texts, ShapeExporterOptions* exporter);

}  // namespace velamap
