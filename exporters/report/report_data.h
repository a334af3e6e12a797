// Everything that the report shows, gathered to one JSON text. The page computes nothing but
// colours and pictures from it; its keys stand in the README of this room.

#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "exporters/scale/metric_scale.h"
#include "exporters/scale/model_metrics.h"
#include "exporters/scale/scale_audit.h"
#include "exporters/shape/marker_shape.h"
#include "exporters/shape/shape_metrics.h"
#include "importer/layout/layout.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct ReportLeftOut {
  std::string name;  // of the image; the id of the marker
  std::string reason;
};

// The frame of the shape, and how to look at it.
struct ReportFrame {
  std::string name;         // what origin and axes are, in a few words
  Eigen::Vector3d up;       // unit length, shape frame
  Eigen::Vector3d forward;  // the direction in which "front" looks, unit length, normal to `up`
};

// A figure and its standard deviation.
struct ReportFigure {
  double value = 0.0;
  std::optional<double> sigma;
};

struct ReportSection {
  std::string name;
  double height_m = 0.0;
  std::optional<ReportFigure> chord_m, camber_percent, draft_percent, entry_deg, exit_deg,
      twist_deg;
  std::vector<Eigen::Vector2d> profile_m;           // in the section's plane, x along the chord
  std::vector<Eigen::Vector3d> profile_in_shape_m;  // the same curve in 3D; may be empty
};

struct ReportSurface {
  std::vector<Eigen::Vector3d> x_in_shape_m;
  std::vector<std::array<int, 3>> triangles;
};

struct ReportInput {
  const Model& metric_model;  // unit m, world frame = shape frame
  const Layout& layout;
  const MarkerShape& shape;
  const ShapeMetrics& metrics;
  const ModelMetrics& model_metrics;
  const ScaleEstimate& scale;
  std::string title = {};
  std::string version = {};     // of the program
  std::string created = {};     // date and time; empty: the report names none
  std::string image_path = {};  // folder of the images; empty: no picture of the central one
  // Nothing: as the central camera sees the shape.
  std::optional<ReportFrame> frame = {};
  const AdjustmentUncertainty* uncertainty = nullptr;  // null where none was computed
  const ScaleAudit* audit = nullptr;                   // null where none was made
  std::vector<ReportLeftOut> images_left_out = {};
  std::vector<ReportLeftOut> markers_left_out = {};  // those of the layout that miss are added
  // Needed to repeat the run: options as they were given, versions of the libraries.
  std::vector<std::pair<std::string, std::string>> options = {};
  std::vector<std::pair<std::string, std::string>> versions = {};
  std::vector<ReportSection> sections = {};
  std::optional<ReportSurface> surface = {};
};

// A JSON object in UTF-8 without line breaks; `<` only as an escape, so that it can stand inside an
// HTML script element. What is not known has no key. Throws DataError for a model without images.
std::string ReportJson(const ReportInput& input);

}  // namespace velamap
