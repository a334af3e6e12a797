// What a whole reconstruction prints at its end: a page for people, or all figures for programs.

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "exporters/formats/metrics_report.h"
#include "exporters/report/report_data.h"
#include "exporters/report/verdict.h"
#include "exporters/shape_exporter.h"
#include "importer/camera/calibration_writer.h"
#include "reconstruct/registration/registration.h"
#include "workflows/run/adjustment.h"
#include "workflows/run/workspace.h"

namespace velamap {

enum class SummaryFormat { kText, kJson };

struct ReconstructionSummary {
  int num_images = 0;  // images used
  int num_images_total = 0;
  std::vector<ReportLeftOut> images_left_out, images_not_needed;
  std::vector<DroppedMarker> dropped_markers;
  AdjustmentResult adjustment;
  ShapeExportReport shape;
  Verdict verdict;
};

// The camera, and whether the file at `path` that holds it is of use for other clips: not if it is
// uncertain, or comes from a result that is bad.
std::string FoundCameraText(const EstimatedCamera& camera, const Verdict& verdict,
                            const std::string& path);

// About ten lines: the verdict with its reasons, then one line each for the markers, the size, the
// images, the sections and the rig of each sail, the surfaces and a camera that was found, and the
// files to open.
void PrintSummary(const ReconstructionSummary& summary, const WorkspacePaths& paths,
                  std::ostream& out);

// The same with all figures. README.md of this folder lists the keys; those of the shape and the
// model are those of shape_analyzer.
MetricsReport SummaryMetrics(const ReconstructionSummary& summary, const WorkspacePaths& paths);

}  // namespace velamap
