// The design that the report of a reconstruction draws beside the measured sections.

#pragma once

#include <memory>
#include <string>

#include "exporters/design/mesh_distance.h"
#include "exporters/design/mesh_reader.h"
#include "exporters/report/report_data.h"
#include "exporters/shape_exporter.h"
#include "importer/layout/layout.h"
#include "workflows/options/option_parser.h"

namespace velamap {

struct DesignOptions {
  std::string path;  // empty for none
  MeshReadOptions mesh;
};

// --design_path and --design_unit.
OptionGroup DescribeOptions(DesignOptions* options);

// Throws InputError if the path does not name a surface (IsMeshPath()), and for a unit that would
// change nothing.
void CheckDesign(const DesignOptions& options, const TypedNames& typed);

// Null without a path. Throws the errors of ReadMesh().
std::unique_ptr<MeshDistance> ReadDesign(const DesignOptions& options);

// Fits the markers of the sail to `design`, which ReadDesign(options) has read, and adds to each
// section of `input` the profile of the design there. The sections of `input` are those of `shape`,
// in the same order. The shape does not depend on this, so a design that cannot be compared only
// gives a warning.
void AddDesign(const DesignOptions& options, const MeshDistance& design,
               const ShapeExportReport& shape, const Layout& layout,
               const SectionOptions& section_options, ReportInput* input);

}  // namespace velamap
