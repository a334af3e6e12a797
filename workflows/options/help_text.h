// The options of a command as text, for help, manual pages and shell completion.

#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "workflows/options/option_parser.h"

namespace velamap {

inline constexpr char kProgramDescription[] =
    "metric 3D shape from pictures of coded markers, through COLMAP";

enum class HelpLength {
  kShort,  // --help or -h: the options that are required or common
  kAll,    // --help_all
};

// The help that the arguments request; nothing if they request none.
std::optional<HelpLength> RequestedHelp(const std::vector<std::string>& arguments);

struct ShownOption {
  std::string name;  // without dashes
  std::string unit;
  std::string default_text;  // empty: none
  std::string description;   // with short names, and whether it is required
  bool is_path = false;
  std::vector<std::string> choices;  // accepted values, if these are a fixed set of names
};

struct ShownGroup {
  std::string title;
  std::vector<ShownOption> options;
};

// The options of the command and --project_path, without groups that would be empty.
std::vector<ShownGroup> ShownOptions(const CommandSyntax& syntax, HelpLength length);

void PrintHelp(const CommandSyntax& syntax, HelpLength length, std::ostream& out);

}  // namespace velamap
