// The page and its libraries as part of the program, in UTF-8. exporters/report/embed.cmake writes
// the definitions.

#pragma once

#include <string_view>

namespace velamap {

extern const std::string_view kReportPage;       // HTML with {{NAME}} as placeholders of the others
extern const std::string_view kCalibrationPage;  // the same, without scripts
extern const std::string_view kComparisonPage;
extern const std::string_view kReportView;        // HTML of the 3D view, in the first and the third
extern const std::string_view kComparisonScript;  // JavaScript of that page
extern const std::string_view kReportStyle;       // CSS
extern const std::string_view kReportScript;      // JavaScript of the page
extern const std::string_view kReportThree;       // three.js and its OrbitControls
extern const std::string_view kReportChart;       // Chart.js
extern const std::string_view kReportLicences;    // of the libraries, plain text

}  // namespace velamap
