// What the report and the verdict of a reconstruction are made of.

#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "exporters/report/report_data.h"
#include "exporters/shape_exporter.h"

namespace velamap {

// Collects what the report shows of an exported shape, except its log, title and origin. The result
// refers to `report` and `layout`, which must outlive it.
ReportInput MakeReportInput(const ShapeExportReport& report, const Layout& layout,
                            const SteadinessVerdict& steadiness);

// The name of the video or of the folder of photographs; of the folder around `images`, which does
// not say what they show.
std::string ReportTitle(const std::filesystem::path& source);

// The options as they were typed, `--name value` or `--name=value`, as pairs.
std::vector<std::pair<std::string, std::string>> TypedOptions(
    const std::vector<std::string>& arguments);

// Removes the user's folders from the texts of the report, because reports are passed on to others.
void LeaveFoldersOut(ReportInput* input);

}  // namespace velamap
