#include "workflows/options/option_parser.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>
#include <boost/program_options.hpp>

#include "importer/base/error.h"
#include "importer/base/numbers.h"
#include "importer/text/nearest_name.h"
#include "workflows/options/given_values.h"
#include "workflows/options/help_text.h"
#include "workflows/options/path_check.h"
#include "workflows/options/project_file.h"

namespace velamap {
namespace {

namespace po = boost::program_options;

std::string DidYouMeanOption(const OptionsByName& options, const std::string& unknown_name) {
  std::vector<std::string> names = {"help", "help_all"};
  for (const auto& [name, option] : options) names.push_back(option.name);
  // --help=1 is no misspelling of another option.
  if (std::find(names.begin(), names.end(), unknown_name) != names.end()) return "";
  return DidYouMean(unknown_name, names, "--");
}

// Throws InputError for an option without its value, after which the parser takes the next word.
void CheckTypedValue(const CommandSyntax& syntax, const Option& option, const std::string& given_as,
                     const po::option& given) {
  const std::string& value = given.value.front();
  const bool is_next_word = given.original_tokens.size() > 1;
  if (is_next_word && value.rfind("--", 0) == 0) {
    throw InputError(fmt::format("{}: needs a value, and {} looks like the next option; {}",
                                 given_as, value, HelpHint(syntax)));
  }
  if (value.empty() && option.path_use != PathUse::kNone) {
    throw InputError(fmt::format("{}: needs a value and has an empty one; give a path{}", given_as,
                                 option.required ? "" : ", or leave it out"));
  }
}

GivenValues ReadCommandLine(const CommandSyntax& syntax, const OptionsByName& options,
                            const std::vector<std::string>& arguments) {
  namespace style = po::command_line_style;
  GivenValues values;
  try {
    const po::options_description description = DescribeForParsing(options);
    const auto parsed =
        po::command_line_parser(arguments)
            .options(description)
            .style(style::allow_long | style::long_allow_adjacent | style::long_allow_next)
            .allow_unregistered()
            .run();
    for (const auto& given : parsed.options) {
      if (given.position_key >= 0) {
        throw InputError(fmt::format("'{}': every value needs its option before it; {}",
                                     given.original_tokens.front(), HelpHint(syntax)));
      }
      const std::string& name = given.string_key;
      if (given.unregistered) {
        throw InputError(fmt::format("--{}: unknown option; {}{}", name,
                                     DidYouMeanOption(options, name), HelpHint(syntax)));
      }
      CheckTypedValue(syntax, options.at(name), "--" + name, given);
      AddGiven(options.at(name), name, {given.value.front(), "--" + name}, &values);
    }
  } catch (const po::invalid_command_line_syntax& error) {
    throw InputError(fmt::format("{}: needs a value; {}", error.tokens(), HelpHint(syntax)));
  } catch (const po::error& error) {
    throw InputError(fmt::format("{}; {}", error.what(), HelpHint(syntax)));
  }
  return values;
}

struct Setter {
  const GivenValue& given;

  template <typename Number>
  void SetNumber(const char* kind, Number* value) const {
    if (!ParseNumber(given.text, value) || !std::isfinite(static_cast<double>(*value))) {
      throw InputError(fmt::format("{}: '{}' is not a {}, or is too large{}", given.given_as,
                                   given.text, kind,
                                   std::is_floating_point_v<Number> ? DecimalPointHint() : ""));
    }
  }

  // For 0,1 as many languages write it.
  std::string DecimalPointHint() const {
    std::string text = given.text;
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos) return "";
    text[comma] = '.';
    double number = 0.0;
    return ParseNumber(text, &number) ? "; write a decimal point: " + text : "";
  }

  void operator()(std::string* value) const { *value = given.text; }
  void operator()(int* value) const { SetNumber("whole number", value); }
  void operator()(double* value) const { SetNumber("number", value); }
  void operator()(std::optional<double>* value) const { SetNumber("number", &value->emplace()); }
  void operator()(bool* value) const {
    if (given.text != "0" && given.text != "1") {
      throw InputError(fmt::format("{}: '{}' is neither 0 nor 1; give 0 (no) or 1 (yes)",
                                   given.given_as, given.text));
    }
    *value = given.text == "1";
  }
  void operator()(const ParsedValue& value) const { value.set(given.text, given.given_as); }
};

void SetOption(const CommandSyntax& syntax, const Option& option, const GivenValues& values) {
  const auto given = values.find(option.name);
  if (option.required && (given == values.end() || given->second.text.empty())) {
    throw InputError(
        fmt::format("--{}: missing; {} ({})", option.name, option.description, HelpHint(syntax)));
  }
  if (given == values.end()) return;
  std::visit(Setter{given->second}, option.target);
  CheckRange(option, given->second.given_as);
}

// Adds the values of the preset for the options of the command that are not given, and says which.
void AddPreset(const CommandSyntax& syntax, const OptionsByName& options, GivenValues* values) {
  if (syntax.preset == nullptr) return;
  const Option preset = PresetOption(syntax.preset);
  SetOption(syntax, preset, *values);
  std::string set, given;
  for (const auto& [name, value] : PresetValues(syntax.preset->name)) {
    if (options.count(name) == 0) continue;
    const auto [entry, is_set] = values->emplace(name, GivenValue{value, "--" + preset.name});
    (is_set ? set : given) += fmt::format(" --{} {}", name, entry->second.text);
  }
  if (set.empty() && given.empty()) return;
  syntax.preset->effect =
      fmt::format("preset {} sets{}{}{}", values->at(preset.name).text,
                  set.empty() ? " nothing" : set, given.empty() ? "" : "; given instead:", given);
}

}  // namespace

OptionGroup ProjectGroup(std::string* project_path) {
  return {
      "Project file",
      {Common(PathOption(kProjectPath, PathUse::kReadsFile, project_path,
                         "ini file with the same options, of this and other commands; the command "
                         "line takes precedence; an option without effect is an error there and "
                         "ignored in this file"))}};
}

std::set<std::string> OptionNames(const CommandSyntax& syntax) {
  std::set<std::string> names;
  for (const auto& [name, option] : IndexByName(syntax.groups)) names.insert(name);
  return names;
}

bool ParseOptions(const CommandSyntax& syntax, const std::vector<std::string>& arguments,
                  const std::set<std::string>& known_names) {
  if (RequestedHelp(arguments)) return false;
  std::string project_path;
  std::vector<OptionGroup> groups = syntax.groups;
  groups.push_back(ProjectGroup(&project_path));
  const OptionsByName options = IndexByName(groups);
  GivenValues values = ReadCommandLine(syntax, options, arguments);
  if (syntax.typed != nullptr) {
    for (const auto& [name, value] : values) syntax.typed->insert(name);
  }
  if (const auto project = values.find(kProjectPath); project != values.end()) {
    CheckInputKind(project->second.given_as, project->second.text);
    GivenValues from_file = ReadProjectFile(syntax, options, project->second.text, known_names);
    values.merge(from_file);  // keeps what the command line has given
  }
  AddPreset(syntax, options, &values);
  for (const OptionGroup& group : groups) {
    for (const Option& option : group.options) SetOption(syntax, option, values);
  }
  CompletePaths(groups);
  return true;
}

}  // namespace velamap
