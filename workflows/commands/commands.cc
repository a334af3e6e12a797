#include "workflows/commands/commands.h"

#include <iostream>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/text/nearest_name.h"
#include "importer/text/output_date.h"
#include "workflows/options/help_text.h"

namespace velamap {
namespace {

bool IsHelp(const std::string& name) { return name == "help" || RequestedHelp({name}).has_value(); }

Command FindCommand(const std::string& name) {
  std::vector<std::string> names = {"help"};
  for (Command& command : AllCommands()) {
    if (name == command.syntax.name) return std::move(command);
    names.push_back(command.syntax.name);
  }
  throw InputError(fmt::format("{}: unknown command; {}see velamap help (or velamap --help)", name,
                               DidYouMean(name, names)));
}

void PrintOverview() {
  std::cout << "velamap: " << kProgramDescription
            << "\n\n"
               "Usage:\n"
               "  velamap COMMAND --option value ...\n"
               "  velamap COMMAND --help       the options that most people need\n"
               "  velamap COMMAND --help_all   all options\n";
  for (const CommandGroup& group : CommandGroups()) {
    std::cout << fmt::format("\n{}:\n", group.title);
    for (const Command& command : group.commands) {
      std::cout << fmt::format("  {:<25}{}\n", command.syntax.name, command.syntax.description);
    }
  }
  std::cout << fmt::format("  {:<25}{}\n", "help", "this list, or the options of a command");
  std::cout << "\nExample:\n"
               "  velamap automatic_reconstructor --image_path photos --camera_path camera.yml \\\n"
               "    --layout_path layout.yml --workspace_path result\n";
}

}  // namespace

std::vector<CommandGroup> CommandGroups() {
  return {
      {"Before and while filming",
       {MarkerGenerator(), ShootPlanner(), CameraCalibrator(), ClipChecker()}},
      {"From pictures to the shape, in one call", {AutomaticReconstructor()}},
      {"The same in steps",
       {MarkerImporter(), DatabaseMerger(), FrameRegistrator(), BundleAdjuster(), ShapeExporter()}},
      {"Judging and comparing shapes", {ShapeAnalyzer(), ShapeComparer(), CentralFrameSweeper()}},
      {"About velamap", {Version()}}};
}

std::vector<Command> AllCommands() {
  std::vector<Command> commands;
  for (CommandGroup& group : CommandGroups()) {
    for (Command& command : group.commands) commands.push_back(std::move(command));
  }
  return commands;
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
    return PrintHelp(FindCommand(rest.front()).syntax,
                     RequestedHelp(rest).value_or(HelpLength::kShort), std::cout);
  }
  const Command command = FindCommand(name == "--version" ? "version" : name);
  if (!ParseOptions(command.syntax, rest, AllOptionNames())) {
    return PrintHelp(command.syntax, RequestedHelp(rest).value(), std::cout);
  }
  OutputDate();  // reports an invalid SOURCE_DATE_EPOCH before the work, not after it
  command.run(rest);
}

}  // namespace velamap
