#include "workflows/install/shell_completion.h"

#include <map>
#include <ostream>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "workflows/options/help_text.h"

namespace velamap {
namespace {

std::vector<ShownOption> OptionsOf(const Command& command) {
  std::vector<ShownOption> options;
  for (const ShownGroup& group : ShownOptions(command.syntax, HelpLength::kAll)) {
    options.insert(options.end(), group.options.begin(), group.options.end());
  }
  return options;
}

// The options of all commands; an option means the same everywhere.
std::map<std::string, ShownOption> OptionsByName(const std::vector<Command>& commands) {
  std::map<std::string, ShownOption> options;
  for (const Command& command : commands) {
    for (const ShownOption& option : OptionsOf(command)) options.emplace(option.name, option);
  }
  return options;
}

// The values of an option as a pattern of `case` completes them.
void WriteBashValues(const std::map<std::string, ShownOption>& options, std::ostream& out) {
  std::set<std::string> paths;
  for (const auto& [name, option] : options) {
    if (option.is_path) {
      paths.insert("--" + name);
    } else if (!option.choices.empty()) {
      out << fmt::format("    --{}) words=\"{}\" ;;\n", name, fmt::join(option.choices, " "));
    }
  }
  out << fmt::format(
      "    {})\n"
      "      compopt -o filenames\n"
      "      mapfile -t COMPREPLY < <(compgen -f -- \"$current\")\n"
      "      return ;;\n",
      fmt::join(paths, " | "));
}

// Escapes text in single quotes for _arguments, where colons and brackets have a meaning.
std::string ZshText(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\'') {
      escaped += "'\\''";
      continue;
    }
    if (c == ':' || c == '[' || c == ']' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string ZshValues(const ShownOption& option) {
  if (option.is_path) return "_files";
  return option.choices.empty() ? "" : fmt::format("({})", fmt::join(option.choices, " "));
}

}  // namespace

void WriteBashCompletion(const std::vector<Command>& commands, std::ostream& out) {
  std::vector<std::string> names = {"help"};
  for (const Command& command : commands) names.push_back(command.syntax.name);
  out << "# Completion of velamap in bash, written from the program's table of options.\n"
         "_velamap() {\n"
         "  local current=\"${COMP_WORDS[COMP_CWORD]}\" before=\"${COMP_WORDS[COMP_CWORD - 1]}\" "
         "words=\"\"\n"
         "  COMPREPLY=()\n"
         "  # bash takes an option apart at its equals sign.\n"
         "  if [[ \"$before\" == \"=\" ]]; then before=\"${COMP_WORDS[COMP_CWORD - 2]}\"; fi\n"
         "  if [[ \"$current\" == \"=\" ]]; then current=\"\"; fi\n"
         "  case \"$before\" in\n"
         "    --help | --help_all) ;;\n";
  WriteBashValues(OptionsByName(commands), out);
  out << "    --*) return ;;\n"
         "  esac\n"
         "  if [[ -z \"$words\" && $COMP_CWORD -gt 1 ]]; then\n"
         "    case \"${COMP_WORDS[1]}\" in\n";
  for (const Command& command : commands) {
    out << fmt::format("      {})\n        words=\"--help --help_all", command.syntax.name);
    for (const ShownOption& option : OptionsOf(command)) out << fmt::format(" --{}", option.name);
    out << "\" ;;\n";
  }
  out << fmt::format(
      "      help) words=\"{0}\" ;;\n"
      "    esac\n"
      "  elif [[ -z \"$words\" ]]; then\n"
      "    words=\"{0}\"\n"
      "  fi\n"
      "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
      "}}\n"
      "complete -F _velamap velamap\n",
      fmt::join(names, " "));
}

void WriteZshCompletion(const std::vector<Command>& commands, std::ostream& out) {
  out << "#compdef velamap\n"
         "# Completion of velamap in zsh, written from the program's table of options.\n"
         "local -a commands=(\n"
         "  'help:this list, or the options of a command'\n";
  for (const Command& command : commands) {
    out << fmt::format("  '{}:{}'\n", command.syntax.name, ZshText(command.syntax.description));
  }
  out << ")\n"
         "if (( CURRENT == 2 )); then\n"
         "  _describe 'command' commands\n"
         "  return\n"
         "fi\n"
         "local command=\"$words[2]\"\n"
         "shift words\n"
         "(( CURRENT-- ))\n"
         "case \"$command\" in\n"
         "  help) _describe 'command' commands ;;\n";
  for (const Command& command : commands) {
    out << fmt::format(
        "  {})\n"
        "    _arguments '(- *)--help[the options that most people need]' \\\n"
        "      '(- *)--help_all[all options]'",
        command.syntax.name);
    for (const ShownOption& option : OptionsOf(command)) {
      out << fmt::format(" \\\n      '--{}=[{}]:{}:{}'", option.name, ZshText(option.description),
                         ZshText(option.unit), ZshValues(option));
    }
    out << " ;;\n";
  }
  out << "esac\n";
}

}  // namespace velamap
