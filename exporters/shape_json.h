// shape.json holds what the tables beside it leave out: their frame and units, and where the shape
// comes from. exporters/formats/README.md lists the keys.

#pragma once

#include <filesystem>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "exporters/formats/length_unit.h"
#include "exporters/report/verdict.h"
#include "exporters/shape/shape_frame.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Where a shape comes from, as far as the command that writes it knows. What is unknown has no key.
struct ShapeOrigin {
  std::string version;                  // of velamap
  std::string clip;                     // name of the video or of the folder of photographs
  std::optional<bool> is_camera_found;  // from the pictures, without a calibration
};

// Names of files, and what they hold in one line.
using DescribedFiles = std::vector<std::pair<std::string, std::string>>;

// The files of a shape that are in `folder`, sorted by name. `unit` is the unit of the formats that
// name none. `part_of_stem` has the part of each surface that has files of its own, by their name
// without its extension.
DescribedFiles DescribeShapeFiles(const std::filesystem::path& folder, LengthUnit unit,
                                  const std::map<std::string, std::string>& part_of_stem = {});

// `model` gives the cameras, `num_markers` is the number of whole markers, `verdict` may be null.
// Its reasons name files without their folders. The date is OutputDate(), whose errors it throws.
void WriteShapeJson(const ShapeFrame& frame, const Model& model, int num_markers,
                    const ShapeOrigin& origin, const Verdict* verdict, const DescribedFiles& files,
                    std::ostream& out);

}  // namespace velamap
