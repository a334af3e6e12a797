// clip_corners: how far the corners that velamap found in a rendered clip are from the truth.

#include <fstream>
#include <vector>

#include <fmt/format.h>
#include <boost/program_options.hpp>

#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "importer/text/csv.h"
#include "tests/support/study/corner_comparison.h"
#include "tests/support/tool_options.h"

namespace velamap {
namespace {

namespace po = boost::program_options;

void WriteCsv(const std::vector<CornerComparison>& comparisons, const std::string& path) {
  std::ofstream out(path);
  CsvWriter csv(out);
  csv.WriteRecord("frame_number", "marker_id", "is_fallback", "is_false", "side_px",
                  "side_error_px", "corner_error_px", "error_over_sigma");
  for (const CornerComparison& one : comparisons) {
    csv.WriteRecord(one.frame_number, one.marker_id, one.is_fallback, one.is_false, one.side_px,
                    one.side_error_px, one.corner_error_px, one.error_over_sigma);
  }
  if (!out) throw InputError(fmt::format("{}: cannot be written", path));
}

// The median of the relative errors of sides is what a scale follows.
void PrintSummary(const std::vector<CornerComparison>& comparisons) {
  std::vector<double> sides_px, errors_px, errors_percent, corner_errors_px, over_sigma;
  int num_false = 0, num_fallback = 0;
  for (const CornerComparison& one : comparisons) {
    num_false += one.is_false;
    num_fallback += one.is_fallback;
    if (one.is_false || one.is_fallback) continue;
    sides_px.push_back(one.side_px);
    errors_px.push_back(one.side_error_px);
    errors_percent.push_back(100 * one.side_error_px / one.side_px);
    corner_errors_px.push_back(one.corner_error_px);
    over_sigma.push_back(one.error_over_sigma);
  }
  fmt::print("num_markers: {}\nnum_fallback: {}\nnum_false: {}\n", comparisons.size(), num_fallback,
             num_false);
  if (sides_px.empty()) return;
  fmt::print(
      "side_px: {:.2f}\nside_bias_px: {:.4f}\nside_bias_percent: {:.4f}\nside_std_px: {:.4f}\n"
      "corner_error_px: {:.4f}\ncorner_error_over_sigma: {:.2f}\n",
      Median(sides_px), ComputeStatistics(errors_px).mean, Median(errors_percent),
      ComputeStatistics(errors_px).standard_deviation, Rms(corner_errors_px), Rms(over_sigma));
}

void Run(int argc, char** argv) {
  std::string clip_path, database_path, csv_path;
  po::options_description description("clip_corners --clip_path FOLDER --database_path FILE");
  auto add = description.add_options();
  add("help", "this text");
  add("clip_path", po::value(&clip_path)->required(), "folder that render_clip wrote");
  add("database_path", po::value(&database_path)->required(), "of an import of its video");
  add("csv_path", po::value(&csv_path), "writes every marker in every frame");
  po::variables_map values;
  if (!ReadToolOptions(description, "clip_corners", argc, argv, &values)) return;
  const ColmapDatabase database(database_path, ColmapDatabase::Mode::kReadOnly);
  const auto comparisons = CompareCorners(clip_path, database.ReadImages());
  if (!csv_path.empty()) WriteCsv(comparisons, csv_path);
  PrintSummary(comparisons);
}

}  // namespace
}  // namespace velamap

int main(int argc, char** argv) { return velamap::RunTool(velamap::Run, argc, argv); }
