#include "workflows/commands/commands.h"

#include <fmt/format.h>

#include "importer/base/error.h"
#include "workflows/options/option_parser.h"

namespace velamap {

const std::vector<Command>& Commands() {
  static const std::vector<Command> commands = {
      {"automatic_reconstructor", RunAutomaticReconstructor,
       "photographs or a video of markers in, a workspace with the metric shape out"},
      {"marker_importer", RunMarkerImporter, "images or video -> COLMAP database"},
      {"frame_registrator", RunFrameRegistrator, "database -> seed model and registration table"},
      {"bundle_adjuster", RunBundleAdjuster, "model -> bundle-adjusted model"},
      {"central_frame_sweeper", RunCentralFrameSweeper,
       "database -> table of the results around many central frames"},
      {"shape_exporter", RunShapeExporter, "model -> metric model and shape files"},
      {"shape_analyzer", RunShapeAnalyzer, "shape -> its errors, alone or against a reference"},
      {"shape_comparer", RunShapeComparer, "shape against another shape or a design's surface"},
      {"help", RunHelp, "this list"},
      {"version", RunVersion, "versions of velamap and of what it works with"},
  };
  return commands;
}

const Command& FindCommand(const std::string& name) {
  std::vector<std::string> names;
  for (const Command& command : Commands()) {
    if (name == command.name) return command;
    names.push_back(command.name);
  }
  const std::string nearest = NearestName(name, names);
  throw InputError(fmt::format("{}: unknown command; {}see velamap help (or velamap --help)", name,
                               nearest.empty() ? "" : "did you mean " + nearest + "? "));
}

}  // namespace velamap
