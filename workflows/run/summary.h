// What a run tells its user at the end, as `key: value` lines.

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/shape_exporter.h"
#include "workflows/run/pipeline.h"
#include "workflows/run/workspace.h"

namespace velamap {

// Counts by reason, with the first few names; "none" for an empty list. Reasons that differ in
// their numbers only are counted together.
std::string LeftOutText(const std::vector<LeftOutImage>& left_out);

// `mean 0.120, std 0.050, median 0.100, min 0.010, max 0.600`.
std::string ErrorText(const Statistics& statistics);

// Sides of a box around all corners, longest first, m. Of the boxes along the shape's principal
// axes and along the sides of each marker it is the one with the least surface, so that it fits a
// curved sheet as well as a cube and does not depend on the frame.
Eigen::Vector3d BoundingBox(const MarkerShape& shape);

// A path as a shell takes it.
std::string ShellQuote(const std::string& text);

// Markers, their errors, scale and size: what shape_exporter and automatic_reconstructor share.
void PrintShapeSummary(const ShapeExportReport& report, std::ostream& out);

struct ReconstructionSummary {
  int num_images = 0;  // images used
  int num_images_total = 0;
  std::vector<LeftOutImage> left_out;
  AdjustmentResult adjustment;
  ShapeExportReport shape;
};

// About fifteen lines: images, markers, errors, scale, where the results are and how to open them.
void PrintSummary(const ReconstructionSummary& summary, const WorkspacePaths& paths,
                  std::ostream& out);

}  // namespace velamap
