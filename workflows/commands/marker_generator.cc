#include <filesystem>
#include <iostream>

#include <fmt/format.h>

#include "importer/layout/layout.h"
#include "importer/print/marker_sheets.h"
#include "workflows/commands/commands.h"
#include "workflows/options/shared_options.h"

namespace velamap {
namespace {

struct MarkerGeneratorCommandOptions : CommandOptions {
  PrintOptions print;
};

// The options of a sail. Its hull is a common option here, because the example has one; in
// shoot_planner, which has the same options, it would make the short help too long.
OptionGroup SailAndHull(SailPlacementOptions* options) {
  OptionGroup group = DescribeOptions(options);
  for (Option& option : group.options) {
    option.is_common = option.is_common || option.name == "hull_markers";
  }
  return group;
}

CommandSyntax Declare(MarkerGeneratorCommandOptions* options) {
  return {"marker_generator",
          "makes sheets of markers to print, a layout to start from, or a calibration board",
          "--arrangement sail --Sail.luff 6 --Sail.foot 3 --Sail.leech 6.2 --hull_markers 8 \\\n"
          "    --marker_length 0.1 --output_path markers",
          {{"Input and output",
            {Required(PathOption("output_path", PathUse::kWritesFolder, &options->paths.output_path,
                                 "folder for sheets.pdf, layout.yml, placement.svg and the like; "
                                 "new, empty, or as an earlier run left it")),
             Common(PathOption("layout_path", PathUse::kReadsLayout, &options->print.layout_path,
                               "layout file (YAML) whose markers are printed, instead of an "
                               "arrangement"))}},
           DescribeOptions(&options->print),
           DescribeOptions(&options->print.sheet),
           SailAndHull(&options->print.sail),
           DescribeOptions(&options->print.grid),
           DescribeOptions(&options->print.codes),
           DescribeOptions(&options->general)}};
}

void Validate(MarkerGeneratorCommandOptions* options) {
  options->print.seed = static_cast<std::uint32_t>(options->general.random_seed);
  if (!options->print.layout_path.empty()) {
    options->print.layout = ReadLayout(options->print.layout_path);
  }
}

void Print(const PrintReport& report, const MarkerGeneratorCommandOptions& options,
           std::ostream& out) {
  out << fmt::format("dictionary: {} ({} codes)\n", report.dictionary, report.num_codes);
  if (report.codes) {
    out << fmt::format("dictionary_distance: {} bits\n", report.codes->min_distance);
    out << fmt::format("dictionary_symmetric_codes: {}\n", report.codes->num_symmetric);
  }
  out << fmt::format("markers: {}\n", report.num_markers);
  out << fmt::format("paper: {}\n", options.print.sheet.paper.name);
  out << fmt::format("sheets: {}\n", report.num_sheets);
  if (report.num_drawings > 0) {
    out << fmt::format(
        "drawing: {} (where the markers go)\n",
        report.num_drawings == 1 ? "page 1" : fmt::format("pages 1-{}", report.num_drawings));
  }
  if (report.margin_mm > 0) out << fmt::format("white_margin_mm: {:.4g}\n", report.margin_mm);
  if (report.drawn_length_mm) {
    out << fmt::format(
        "drawn_length_mm: {:.5g} (the printer that made {:.5g} mm of it does so again)\n",
        *report.drawn_length_mm, 1000 * options.print.layout->marker_length_m);
  }
  for (const std::string& file : report.files) {
    if (file.find('/') == std::string::npos) {
      out << fmt::format("file: {}\n",
                         (std::filesystem::path(options.paths.output_path) / file).string());
    }
  }
  out << "output_path: " << options.paths.output_path << '\n';
  out << "next: print sheets.pdf at 100 % and measure the scale on the sheets\n";
}

void Run(const MarkerGeneratorCommandOptions& options) {
  Print(PrintMarkers(options.print, options.paths.output_path), options, std::cout);
}

}  // namespace

Command MarkerGenerator() {
  return MakeCommand<MarkerGeneratorCommandOptions>(Declare, Validate, Run);
}

}  // namespace velamap
