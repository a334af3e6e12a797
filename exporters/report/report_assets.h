// The page and its libraries as part of the program, in UTF-8. exporters/report/embed.cmake writes
// the definitions.

#pragma once

#include <string_view>

namespace velamap {

// HTML with {{NAME}} in place of the texts below.
extern const std::string_view kReportPage;
extern const std::string_view kComparisonPage;
extern const std::string_view kCalibrationPage;  // has no scripts

extern const std::string_view kReportScript;      // JavaScript of the report
extern const std::string_view kComparisonScript;  // JavaScript of the comparison
extern const std::string_view kReportView;        // HTML of the 3D view of both
extern const std::string_view kReportStyle;       // CSS of all pages
extern const std::string_view kReportThree;       // three.js and its OrbitControls
extern const std::string_view kReportChart;       // Chart.js
extern const std::string_view kReportLicences;    // of the libraries, plain text

}  // namespace velamap
