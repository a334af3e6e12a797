// The page and the libraries that are built into the program; exporters/report/embed.cmake writes
// the definitions. All are text in UTF-8.

#pragma once

#include <string_view>

namespace velamap {

extern const std::string_view kReportPage;      // HTML with {{NAME}} where the others go
extern const std::string_view kReportStyle;     // CSS
extern const std::string_view kReportScript;    // JavaScript of the page
extern const std::string_view kReportThree;     // three.js and its OrbitControls
extern const std::string_view kReportChart;     // Chart.js
extern const std::string_view kReportLicences;  // of the libraries, plain text

}  // namespace velamap
