// Writes report.html, one file that shows a result in any browser without a network. It contains
// the data, the page, three.js (3D view) and Chart.js (charts). The libraries come from the Debian
// packages libjs-three and libjs-chart.js and are part of this program
// (exporters/report/embed.cmake).

#pragma once

#include <iosfwd>

#include "exporters/report/report_data.h"

namespace velamap {

// Throws DataError for a model without images. If the central image cannot be read, the page says
// so.
void WriteReport(const ReportInput& input, std::ostream& out);

}  // namespace velamap
