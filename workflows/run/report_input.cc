#include "workflows/run/report_input.h"

#include "importer/text/shown_text.h"

namespace velamap {

ReportInput MakeReportInput(const ShapeExportReport& report, const Layout& layout,
                            const SteadinessVerdict& steadiness) {
  ReportInput input{report.metric_model,  layout,       report.shape, report.metrics,
                    report.model_metrics, report.scale, report.sail,  report.freeform};
  input.uncertainty = report.uncertainty ? &*report.uncertainty : nullptr;
  input.audit = &report.audit;
  input.steadiness = steadiness;
  input.known_points = &report.known_points;
  return input;
}

std::string ReportTitle(const std::filesystem::path& source) {
  const std::filesystem::path parent = source.parent_path().filename();
  const bool says_nothing = source.filename() == "images" && !parent.empty();
  return (says_nothing ? parent : source.filename()).string();
}

std::vector<std::pair<std::string, std::string>> TypedOptions(
    const std::vector<std::string>& arguments) {
  std::vector<std::pair<std::string, std::string>> options;
  for (const std::string& argument : arguments) {
    const bool is_name = argument.rfind("--", 0) == 0;
    const std::size_t equals = is_name ? argument.find('=') : std::string::npos;
    if (!is_name) {
      if (!options.empty()) options.back().second = argument;
    } else if (equals == std::string::npos) {
      options.emplace_back(argument.substr(2), "");
    } else {
      options.emplace_back(argument.substr(2, equals - 2), argument.substr(equals + 1));
    }
  }
  return options;
}

void LeaveFoldersOut(ReportInput* input) {
  for (std::string& warning : input->warnings) warning = StripFolders(warning);
  for (auto* pairs : {&input->options, &input->versions}) {
    for (auto& [name, value] : *pairs) value = StripFolders(value);
  }
  for (auto* left_out :
       {&input->images_left_out, &input->images_not_needed, &input->markers_left_out}) {
    for (ReportLeftOut& one : *left_out) one.reason = StripFolders(one.reason);
  }
}

}  // namespace velamap
