#include "workflows/commands/commands.h"

#include <iostream>

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "importer/base/error.h"
#include "workflows/options/nearest_name.h"

namespace velamap {
namespace {

bool IsHelp(const std::string& name) { return name == "help" || name == "--help" || name == "-h"; }

Command FindCommand(const std::string& name) {
  std::vector<std::string> names = {"help"};
  for (Command& command : AllCommands()) {
    if (name == command.syntax.name) return std::move(command);
    names.push_back(command.syntax.name);
  }
  const std::string nearest = NearestName(name, names);
  throw InputError(fmt::format("{}: unknown command; {}see velamap help (or velamap --help)", name,
                               nearest.empty() ? "" : "did you mean " + nearest + "? "));
}

void PrintOverview() {
  std::cout << "velamap: metric 3D shape from pictures of coded markers, through COLMAP\n\n"
               "Usage:\n"
               "  velamap COMMAND --option value ...\n"
               "  velamap COMMAND --help\n\n"
               "Commands:\n";
  for (const Command& command : AllCommands()) {
    fmt::print(std::cout, "  {:<25}{}\n", command.syntax.name, command.syntax.description);
  }
  fmt::print(std::cout, "  {:<25}{}\n", "help", "this list, or the options of a command");
  std::cout << "\nExample:\n"
               "  velamap automatic_reconstructor --image_path photos --camera_path camera.yml \\\n"
               "    --layout_path layout.yml --workspace_path result\n";
}

}  // namespace

std::vector<Command> AllCommands() {
  return {MarkerGenerator(),  ShootPlanner(),           CameraCalibrator(),
          ClipChecker(),      AutomaticReconstructor(), MarkerImporter(),
          FrameRegistrator(), BundleAdjuster(),         CentralFrameSweeper(),
          ShapeExporter(),    ShapeAnalyzer(),          ShapeComparer(),
          Version()};
}

std::set<std::string> AllOptionNames() {
  std::set<std::string> names;
  for (const Command& command : AllCommands()) names.merge(OptionNames(command.syntax));
  return names;
}

void RunCommandLine(const Arguments& arguments) {
  const std::string name = arguments.empty() ? "help" : arguments.front();
  const Arguments rest(arguments.begin() + (arguments.empty() ? 0 : 1), arguments.end());
  if (IsHelp(name)) {
    if (rest.empty() || IsHelp(rest.front())) return PrintOverview();
    return PrintHelp(FindCommand(rest.front()).syntax, std::cout);
  }
  const Command command = FindCommand(name == "--version" ? "version" : name);
  if (!ParseOptions(command.syntax, rest, AllOptionNames())) {
    return PrintHelp(command.syntax, std::cout);
  }
  command.run(rest);
}

}  // namespace velamap
