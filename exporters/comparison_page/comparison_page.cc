#include "exporters/comparison_page/comparison_page.h"

#include <fmt/format.h>

#include "exporters/comparison_page/comparison_words.h"
#include "exporters/report/html_page.h"
#include "exporters/report/report_assets.h"
#include "importer/base/atomic_output.h"

namespace velamap {
namespace {

std::string VtsName(const std::string& shape_name, bool is_series, std::size_t field_idx) {
  std::string name = is_series ? "deflection_" + shape_name : "deflection";
  if (field_idx > 0) name += fmt::format("_part{}", field_idx + 1);
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
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const std::string name =
          fmt::format("{} of {} from {}", fields[i].part, comparison.name, input.reference_name);
      WriteFile(folder / VtsName(comparison.name, input.series.size() > 1, i),
                [&](std::ostream& out) { WriteDeflectionVts(fields[i], name, out); });
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
