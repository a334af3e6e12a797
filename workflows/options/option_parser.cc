#include "workflows/options/option_parser.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <ostream>

#include <fmt/format.h>
#include <boost/program_options.hpp>

#include "importer/base/error.h"

namespace velamap {
namespace {

namespace po = boost::program_options;

constexpr const char* kProjectPath = "project_path";

// A value as it was given, and where, for messages.
struct GivenValue {
  std::string text;
  std::string origin;  // "--name" or "file: name"
};
using GivenValues = std::map<std::string, GivenValue>;

std::string DefaultText(const OptionTarget& target) {
  struct Visitor {
    std::string operator()(const std::string* value) const { return *value; }
    std::string operator()(const int* value) const { return fmt::format("{}", *value); }
    std::string operator()(const double* value) const { return fmt::format("{}", *value); }
    std::string operator()(const std::optional<double>* value) const {
      return value->has_value() ? fmt::format("{}", **value) : "";
    }
    std::string operator()(const bool* value) const { return *value ? "1" : "0"; }
    std::string operator()(const ParsedValue& value) const { return value.default_text; }
  };
  return std::visit(Visitor{}, target);
}

po::options_description Describe(const OptionGroup& group) {
  constexpr unsigned kLineLength = 100, kMinDescriptionLength = 50;
  po::options_description description(group.title, kLineLength, kMinDescriptionLength);
  for (const Option& option : group.options) {
    auto* semantic = po::value<std::string>()->value_name(option.unit);
    const std::string text = DefaultText(option.target);
    if (!option.required && !text.empty()) semantic->default_value(text);
    description.add_options()(
        option.name.c_str(), semantic,
        (option.description + (option.required ? " (required)" : "")).c_str());
  }
  return description;
}

OptionGroup ProjectGroup(std::string* project_path) {
  return {"Project file",
          {{kProjectPath, project_path, "path",
            "ini file with the same options; the command line "
            "wins over it"}}};
}

po::options_description DescribeAll(const CommandSyntax& syntax) {
  po::options_description all;
  std::string project_path;
  for (const OptionGroup& group : syntax.groups) all.add(Describe(group));
  all.add(Describe(ProjectGroup(&project_path)));
  return all;
}

std::vector<std::string> OptionNames(const CommandSyntax& syntax) {
  std::vector<std::string> names = {kProjectPath, "help"};
  for (const OptionGroup& group : syntax.groups) {
    for (const Option& option : group.options) names.push_back(option.name);
  }
  return names;
}

std::string HelpHint(const CommandSyntax& syntax) {
  return fmt::format("see velamap {} --help", syntax.name);
}

std::string DidYouMean(const std::string& name, const std::vector<std::string>& names,
                       const std::string& dashes) {
  const std::string nearest = NearestName(name, names);
  return nearest.empty() ? "" : fmt::format("did you mean {}{}? ", dashes, nearest);
}

GivenValues ReadCommandLine(const CommandSyntax& syntax, const po::options_description& description,
                            const std::vector<std::string>& arguments) {
  namespace style = po::command_line_style;
  GivenValues values;
  try {
    const auto parsed =
        po::command_line_parser(arguments)
            .options(description)
            .style(style::allow_long | style::long_allow_adjacent | style::long_allow_next)
            .allow_unregistered()
            .run();
    for (const auto& option : parsed.options) {
      if (option.position_key >= 0) {
        throw InputError(fmt::format("'{}': every value needs its option before it; {}",
                                     option.original_tokens.front(), HelpHint(syntax)));
      }
      const std::string& name = option.string_key;
      if (option.unregistered) {
        throw InputError(fmt::format("--{}: unknown option; {}{}", name,
                                     DidYouMean(name, OptionNames(syntax), "--"),
                                     HelpHint(syntax)));
      }
      if (!values.emplace(name, GivenValue{option.value.front(), "--" + name}).second) {
        throw InputError(fmt::format("--{}: given twice; give it once", name));
      }
    }
  } catch (const po::error& error) {
    throw InputError(fmt::format("{}; {}", error.what(), HelpHint(syntax)));
  }
  return values;
}

GivenValues ReadProjectFile(const CommandSyntax& syntax, const po::options_description& description,
                            const std::string& path, const std::set<std::string>& other_names) {
  std::ifstream stream(path);
  if (!stream || stream.peek() == std::ifstream::traits_type::eof()) {
    throw InputError(
        fmt::format("--{} {}: cannot be read, or is empty; give an ini file with "
                    "key=value lines",
                    kProjectPath, path));
  }
  GivenValues values;
  try {
    constexpr bool kAllowUnregistered = true;
    for (const auto& option :
         po::parse_config_file(stream, description, kAllowUnregistered).options) {
      const std::string& name = option.string_key;
      if (option.unregistered && other_names.count(name) > 0) continue;
      if (option.unregistered || name == kProjectPath) {
        throw InputError(fmt::format("{}: unknown key {}; {}{}", path, name,
                                     DidYouMean(name, OptionNames(syntax), ""), HelpHint(syntax)));
      }
      if (!values.emplace(name, GivenValue{option.value.front(), path + ": " + name}).second) {
        throw InputError(fmt::format("{}: {} is given twice; give it once", path, name));
      }
    }
  } catch (const po::error& error) {
    throw InputError(
        fmt::format("{}: {}; expected key=value lines, and [Section] before keys of a "
                    "section",
                    path, error.what()));
  }
  return values;
}

template <typename Number>
void ParseNumber(const GivenValue& given, const char* kind, Number* value) {
  const char* const end = given.text.data() + given.text.size();
  const auto [rest, error] = std::from_chars(given.text.data(), end, *value);
  if (error != std::errc() || rest != end || !std::isfinite(static_cast<double>(*value))) {
    throw InputError(
        fmt::format("{}: '{}' is no {} in range; give one", given.origin, given.text, kind));
  }
}

struct Setter {
  const GivenValue& given;

  void operator()(std::string* value) const { *value = given.text; }
  void operator()(int* value) const { ParseNumber(given, "whole number", value); }
  void operator()(double* value) const { ParseNumber(given, "number", value); }
  void operator()(std::optional<double>* value) const {
    ParseNumber(given, "number", &value->emplace());
  }
  void operator()(bool* value) const {
    if (given.text != "0" && given.text != "1") {
      throw InputError(fmt::format("{}: '{}' is neither 0 nor 1; give 0 (no) or 1 (yes)",
                                   given.origin, given.text));
    }
    *value = given.text == "1";
  }
  void operator()(const ParsedValue& value) const { value.set(given.text); }
};

int EditDistance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substitution = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
    }
  }
  return row[b.size()];
}

}  // namespace

bool ParseOptions(const CommandSyntax& syntax, const std::vector<std::string>& arguments,
                  const std::set<std::string>& other_names) {
  for (const std::string& argument : arguments) {
    if (argument == "--help" || argument == "-h") return false;
  }
  const po::options_description description = DescribeAll(syntax);
  GivenValues values = ReadCommandLine(syntax, description, arguments);
  if (const auto project = values.find(kProjectPath); project != values.end()) {
    // insert() keeps what the command line has given.
    const GivenValues from_file =
        ReadProjectFile(syntax, description, project->second.text, other_names);
    values.insert(from_file.begin(), from_file.end());
  }
  for (const OptionGroup& group : syntax.groups) {
    for (const Option& option : group.options) {
      const auto it = values.find(option.name);
      if (option.required && (it == values.end() || it->second.text.empty())) {
        throw InputError(fmt::format("--{}: missing; {} ({})", option.name, option.description,
                                     HelpHint(syntax)));
      }
      if (it != values.end()) std::visit(Setter{it->second}, option.target);
    }
  }
  return true;
}

void PrintHelp(const CommandSyntax& syntax, std::ostream& out) {
  out << "velamap " << syntax.name << ": " << syntax.description << "\n\n"
      << DescribeAll(syntax) << "\n\nExample:\n  velamap " << syntax.name << ' ' << syntax.example
      << '\n';
}

std::string NearestName(const std::string& text, const std::vector<std::string>& names) {
  std::string nearest;
  int smallest = static_cast<int>(text.size() + 1) / 2;  // beyond half of the letters it is a guess
  for (const std::string& name : names) {
    // A section that was left out counts as one mistake.
    const std::size_t dot = name.find('.');
    int distance = EditDistance(text, name);
    if (dot != std::string::npos) {
      distance = std::min(distance, 1 + EditDistance(text, name.substr(dot + 1)));
    }
    if (distance < smallest || (distance == smallest && nearest.empty())) {
      smallest = distance;
      nearest = name;
    }
  }
  return nearest;
}

}  // namespace velamap
