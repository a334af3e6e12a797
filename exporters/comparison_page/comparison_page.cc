#include "exporters/comparison_page/comparison_page.h"

#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "exporters/comparison_page/comparison_words.h"
#include "exporters/report/html_page.h"
#include "exporters/report/report_assets.h"
#include "importer/base/atomic_output.h"
#include "importer/text/markup.h"

namespace velamap {
namespace {

std::string_view Asset(std::string_view name) {
  if (name == "VIEW") return kReportView;
  if (name == "STYLE") return kReportStyle;
  if (name == "SCRIPT") return kComparisonScript;
  if (name == "THREE") return kReportThree;
  throw std::logic_error("the comparison's page names an unknown part: " + std::string(name));
}

std::string VtsName(const std::string& shape_name, bool is_series, std::size_t field_idx) {
  std::string name = is_series ? "deflection_" + shape_name : "deflection";
  if (field_idx > 0) name += fmt::format("_part{}", field_idx + 1);
  return name + ".vts";
}

}  // namespace

void WriteComparisonPage(const ComparisonPageInput& input, std::ostream& out) {
  WriteHtmlPage(
      kComparisonPage,
      [&](std::string_view name) -> std::string {
        if (name == "TITLE") return EscapeForMarkup(ComparisonTitle(input));
        if (name == "DATA") return ComparisonJson(input);
        if (name == "LICENCES") return EscapeForMarkup(kReportLicences);
        return std::string(Asset(name));
      },
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
