// Models of a synthetic sail with everything that a report shows.

#pragma once

#include <filesystem>
#include <string>

#include "exporters/report/report_data.h"

namespace velamap {

struct ReportExample {
  Layout layout;
  Model model;  // metric
  MarkerShape shape;
  ShapeMetrics metrics;
  ModelMetrics model_metrics;
  ScaleEstimate scale;
  SailShape sail;
  FreeformShape freeform;

  // Refers to this object; title, version and options set.
  ReportInput Input() const;
};

// `num_rows` lines of 13 markers of 100 mm, seen by `num_images` cameras with corner noise of
// 0.2 px; the layout names marker 8000 too, which nobody sees.
ReportExample MakeReportExample(int num_rows, int num_images);

// A section of the sail whose curve is the straight line between two points.
Section StraightSection(const std::string& name, const Eigen::Vector3d& luff_in_frame_m,
                        const Eigen::Vector3d& leech_in_frame_m);

// A grey picture of the central image's size, black where its markers are, in `folder`.
void DrawCentralImage(const Model& model, const std::filesystem::path& folder);

}  // namespace velamap
