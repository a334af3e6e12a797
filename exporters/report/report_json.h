// Parts of the report's JSON.

#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "exporters/formats/metrics_report.h"
#include "exporters/report/report_data.h"
#include "reconstruct/model/reprojection.h"

namespace velamap {

using ReportJsonValue = nlohmann::ordered_json;

// The object of WriteMetricsJson().
ReportJsonValue MetricsJson(const MetricsReport& report);

ReportJsonValue VectorJson(const Eigen::Vector3d& vector);

// Signed deviation of a whole marker's area from the printed one, %.
double AreaDeviationPercent(const ShapeMarker& marker, const Layout& layout);

// One object per marker of the shape, by id.
ReportJsonValue MarkersJson(const ReportInput& input, const std::vector<ObservationError>& errors);

// One object per image of the model, by name.
ReportJsonValue ImagesJson(const ReportInput& input);

// The central image as a JPEG with detected and reprojected corners, px.
ReportJsonValue PictureJson(const ReportInput& input, const std::vector<ObservationError>& errors);

}  // namespace velamap
