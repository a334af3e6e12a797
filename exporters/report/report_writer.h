// report.html: one file that shows a result in any browser, without a network. Data, page, three.js
// (turning 3D view) and Chart.js (charts) are inside; the libraries come from Debian's packages
// libjs-three and libjs-chart.js and are built into this program (exporters/report/embed.cmake).

#pragma once

#include <iosfwd>

#include "exporters/report/report_data.h"

namespace velamap {

// Throws DataError for a model without images. A central image that cannot be read is no error: the
// page says why there is no picture.
void WriteReport(const ReportInput& input, std::ostream& out);

}  // namespace velamap
