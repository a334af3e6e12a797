#include "exporters/comparison_page/comparison_page.h"

#include <fmt/format.h>

#include "exporters/comparison_page/comparison_words.h"
#include "exporters/report/html_page.h"
#include "exporters/report/report_assets.h"
#include "importer/base/atomic_output.h"

namespace velamap {
namespace {

// The number of a part among those with lines, from 1. A part whose surface fails has no field, so
// the index of a field does not give its part.
int NumberOfPart(const std::string& name, const Layout& layout) {
  int number = 0;
  for (const LayoutPart& part : layout.parts) {
    if (!part.horizontal.empty()) ++number;
    if (part.name == name) break;
  }
  return number;
}

std::string VtsName(const std::string& shape_name, bool is_series, int part_number) {
  std::string name = is_series ? "deflection_" + shape_name : "deflection";
  if (part_number > 1) name += fmt::format("_part{}", part_number);
  return name + ".vts";
}

}  // namespace

void WriteComparisonPage(const ComparisonPageInput& input, std::ostream& out) {
  WriteScriptPage(kComparisonPage, kComparisonScript, ComparisonTitle(input), ComparisonJson(input),
                  out);
}

void WriteComparisonFiles(const ComparisonPageInput& input, const std::filesystem::path& folder) {
  std::vector<NamedDeflections> deflections;
  for (const Comparison& comparison : input.series) {
    const std::vector<DeflectionField>& fields = comparison.deflections.fields;
    for (const DeflectionField& field : fields) {
      const std::string name =
          fmt::format("{} of {} from {}", field.part, comparison.name, input.reference_name);
      const int number = NumberOfPart(field.part, input.layout);
      WriteFile(folder / VtsName(comparison.name, input.series.size() > 1, number),
                [&](std::ostream& out) { WriteDeflectionVts(field, name, out); });
    }
    if (!fields.empty()) deflections.push_back({comparison.name, &comparison.deflections});
  }
  if (!deflections.empty()) {
    WriteFile(folder / "deflection.csv",
              [&](std::ostream& out) { WriteDeflectionCsv(deflections, out); });
  }
  WriteFile(folder / "comparison.html",
            [&](std::ostream& out) { WriteComparisonPage(input, out); });
}

}  // namespace velamap
