// Options of what is made of the shape: frame, sections, surface.

#pragma once

#include <optional>
#include <string>

#include "exporters/shape_exporter.h"
#include "workflows/options/option_parser.h"

namespace velamap {

struct SailOptionTexts {
  std::optional<double> edge_length_mm;
  std::optional<double> chord_deviation_mm;
  std::string edges_path;
};

// Declares --frame, --Section.* and --Surface.*, which write into `exporter` and `texts`.
OptionGroup SailGroup(ShapeExporterOptions* exporter, SailOptionTexts* texts);

// Once the options are set: reads the edges' file and checks everything. Throws InputError that
// names option or file.
void CompleteSailOptions(const SailOptionTexts& texts, ShapeExporterOptions* exporter);

}  // namespace velamap
