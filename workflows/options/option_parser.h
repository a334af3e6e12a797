// Reads the options of a command from the command line and from a project file.
//
// Names are in COLMAP's style, --database_path or --Video.frame_step. The file that --project_path
// names holds the same names, as COLMAP's ini files do: keys without a section first, then
// [Section] and key=value. The command line takes precedence over the file.

#pragma once

#include <set>
#include <string>
#include <vector>

#include "importer/base/option.h"
#include "workflows/options/preset.h"

namespace velamap {

// The options that were typed on the command line, each by the first of its names, without dashes.
// Unlike those of a project file, they cannot be meant for another command.
using TypedNames = std::set<std::string>;

struct CommandSyntax {
  std::string name;
  std::string description;  // one line
  std::string example;      // arguments of a typical call
  std::vector<OptionGroup> groups;
  Preset* preset = nullptr;  // of a command with PresetOption()
  TypedNames* typed = nullptr;
};

// --project_path, which every command has beside its own options.
OptionGroup ProjectGroup(std::string* project_path);

// All names of the command's options, including short and old ones.
std::set<std::string> OptionNames(const CommandSyntax& syntax);

// Sets the options that `arguments`, which follow the command's name, and their project file give.
// The file may hold `known_names`, the options of all commands, so that one file serves them all.
// What neither gives comes from the preset, whose Preset::effect is set. Fills `syntax.typed`.
// Returns false, having set nothing, when help is asked for (help_text.h). Throws InputError for
// - an option that is unknown (the message names the nearest one), given twice or by two of its
//   names, or required and missing;
// - a value that is missing, of another type, beyond its range, or empty for a path;
// - a project file that is missing or malformed, or holds an unknown key;
// - paths that CompletePaths() (path_check.h) refuses.
bool ParseOptions(const CommandSyntax& syntax, const std::vector<std::string>& arguments,
                  const std::set<std::string>& known_names);

}  // namespace velamap
