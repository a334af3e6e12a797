// Prints results of commands as `key: value` lines.

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "exporters/report/report_data.h"
#include "exporters/shape_exporter.h"
#include "reconstruct/registration/registration.h"

namespace velamap {

// How many are left out for each reason, with the first few names; "none" for an empty list.
// Reasons that differ only in their numbers are counted together. `kind`, such as "marker", stands
// before the names.
std::string LeftOutText(const std::vector<ReportLeftOut>& left_out, const std::string& kind = "");

// The markers, named by their ids.
std::vector<ReportLeftOut> NamedById(const std::vector<DroppedMarker>& markers);

// `mean 0.120, std 0.050, median 0.100, min 0.010, max 0.600`.
std::string ErrorText(const Statistics& statistics);

// Quotes a path for a shell where that is needed.
std::string ShellQuote(const std::string& text);

// Returns the warnings logged so far, for the report, and then logs which measured distances and
// known points contradict the shape: the report has these as key numbers.
std::vector<std::string> WarningsBeforeContradictions(const ShapeExportReport& report);

// Warns of markers that the layout does not name.
void WarnOfOtherMarkers(const ShapeMetrics& metrics);

// Warns of lines and heights that have no section, with the reason.
void WarnOfMissingSections(const SectionReport& sections);

// What there is to say about the surfaces of the sails, then about the others.
std::vector<std::string> SurfaceNotes(const ShapeExportReport& report);

// Prints what shape_exporter says of a shape: markers, their errors, scale, size, sections.
void PrintShapeSummary(const ShapeExportReport& report, std::ostream& out);

// Prints bend and sag of the luff and the sheeting angle of each sail, where they are known.
void PrintRigs(const std::vector<RigNumbers>& rigs, std::ostream& out);

// Prints the rolling shutter if it was estimated.
void PrintRollingShutter(const AdjustmentUncertainty& uncertainty, std::ostream& out);

}  // namespace velamap
