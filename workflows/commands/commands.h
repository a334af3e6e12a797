// The commands of the program. Each reads files, calls the entry points of the rooms and prints its
// results as `key: value` on stdout. Errors leave it as exceptions (importer/base/error.h).

#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "workflows/options/option_parser.h"
#include "workflows/run/logging.h"

namespace velamap {

using Arguments = std::vector<std::string>;

struct Command {
  CommandSyntax syntax;                                 // its options set values that `run` uses
  std::function<void(const Arguments& arguments)> run;  // `arguments` as they were typed
};

// Makes a command that owns its options. `declare` is called at once; `validate` and `run` are
// called when the command runs, after the log level has been set from the options.
template <typename Options>
Command MakeCommand(CommandSyntax (*declare)(Options*), void (*validate)(Options*),
                    void (*run)(const Options&)) {
  const auto options = std::make_shared<Options>();
  CommandSyntax syntax = declare(options.get());
  syntax.typed = &options->typed;
  return {syntax, [=](const Arguments& arguments) {
            options->arguments = arguments;
            SetLogLevel(options->general.log_level);
            validate(options.get());
            run(*options);
          }};
}

Command CameraCalibrator();
Command ClipChecker();
Command AutomaticReconstructor();
Command MarkerGenerator();
Command MarkerImporter();
Command DatabaseMerger();
Command FrameRegistrator();
Command BundleAdjuster();
Command CentralFrameSweeper();
Command ShapeExporter();
Command ShapeAnalyzer();
Command ShapeComparer();
Command ShootPlanner();
Command Version();

struct CommandGroup {
  std::string title;  // the stage of the work that needs them
  std::vector<Command> commands;
};

// The registry: all commands but help, in the order in which help lists them.
std::vector<CommandGroup> CommandGroups();
std::vector<Command> AllCommands();

// The names of the options of all commands, which a project file may hold.
std::set<std::string> AllOptionNames();

// Runs the command that the first argument names, with the others; shows help where that is asked
// for. Throws InputError, naming the nearest command, for an unknown one.
void RunCommandLine(const Arguments& arguments);

}  // namespace velamap
