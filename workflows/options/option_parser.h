// Options of a command: declared in groups, read from the command line and from an ini file.
//
// Names are COLMAP's style, `--database_path` or `--Video.frame_step`. The file that --project_path
// names holds the same names, as COLMAP's ini files do: keys without a section first, then
// [Section] and key=value. The command line wins over the file.

#pragma once

#include <functional>
#include <iosfwd>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace velamap {

// A value that is checked and converted where it belongs, such as one of a few names.
struct ParsedValue {
  std::string default_text;
  std::function<void(const std::string&)> set;  // throws InputError that names the option
};

// What an option writes to. The value that is there when the option is declared is the default;
// a bool is written 0 or 1, an optional has none.
using OptionTarget =
    std::variant<std::string*, int*, double*, std::optional<double>*, bool*, ParsedValue>;

struct Option {
  std::string name;  // without dashes
  OptionTarget target;
  std::string unit;  // unit or kind of the value, shown by --help: m, px, path, 0|1 ...
  std::string description;
  bool required = false;
};

struct OptionGroup {
  std::string title;
  std::vector<Option> options;
};

struct CommandSyntax {
  std::string name;
  std::string description;  // one line
  std::string example;      // arguments of a typical call
  std::vector<OptionGroup> groups;
};

// Reads the arguments behind the command's name into the options' targets. Keys of a project file
// that are none of the command's but stand in `other_names` (options of other commands) are passed
// over, so that one file can serve all commands. Returns false, having set nothing, when --help or
// -h is among the arguments. Throws InputError: unknown option (names the nearest), one given
// twice, without a value or with one of another type, one that is required and missing; a project
// file that is missing, malformed, or holds an unknown key.
bool ParseOptions(const CommandSyntax& syntax, const std::vector<std::string>& arguments,
                  const std::set<std::string>& other_names);

void PrintHelp(const CommandSyntax& syntax, std::ostream& out);

// The name that `text` was probably meant to be; "" if none comes near.
std::string NearestName(const std::string& text, const std::vector<std::string>& names);

}  // namespace velamap
