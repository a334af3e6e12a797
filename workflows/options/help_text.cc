#include "workflows/options/help_text.h"

#include <ostream>

#include <fmt/format.h>
#include <boost/program_options.hpp>

namespace velamap {
namespace {

namespace po = boost::program_options;

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

ShownOption Show(const Option& option) {
  ShownOption shown{option.name,
                    option.unit,
                    option.required ? "" : DefaultText(option.target),
                    option.description,
                    option.path_use != PathUse::kNone,
                    option.choices};
  if (std::holds_alternative<bool*>(option.target)) shown.choices = {"0", "1"};
  for (const std::string& name : option.short_names) shown.description += "; in short --" + name;
  if (option.required) shown.description += " (required)";
  return shown;
}

po::options_description Describe(const ShownGroup& group) {
  constexpr unsigned kLineLength = 100, kMinDescriptionLength = 50;
  po::options_description description(group.title, kLineLength, kMinDescriptionLength);
  for (const ShownOption& option : group.options) {
    auto* semantic = po::value<std::string>()->value_name(option.unit);
    if (!option.default_text.empty()) semantic->default_value(option.default_text);
    description.add_options()(option.name.c_str(), semantic, option.description.c_str());
  }
  return description;
}

std::size_t NumOptions(const std::vector<ShownGroup>& groups) {
  std::size_t num_options = 0;
  for (const ShownGroup& group : groups) num_options += group.options.size();
  return num_options;
}

}  // namespace

std::optional<HelpLength> RequestedHelp(const std::vector<std::string>& arguments) {
  std::optional<HelpLength> length;
  for (const std::string& argument : arguments) {
    if (argument == "--help_all") return HelpLength::kAll;
    if (argument == "--help" || argument == "-h") length = HelpLength::kShort;
  }
  return length;
}

std::vector<ShownGroup> ShownOptions(const CommandSyntax& syntax, HelpLength length) {
  std::string project_path;
  std::vector<OptionGroup> groups = syntax.groups;
  groups.push_back(ProjectGroup(&project_path));
  std::vector<ShownGroup> shown_groups;
  for (const OptionGroup& group : groups) {
    ShownGroup shown{group.title, {}};
    for (const Option& option : group.options) {
      const bool is_shown = length == HelpLength::kAll || option.required || option.is_common;
      if (is_shown) shown.options.push_back(Show(option));
    }
    if (!shown.options.empty()) shown_groups.push_back(std::move(shown));
  }
  return shown_groups;
}

void PrintHelp(const CommandSyntax& syntax, HelpLength length, std::ostream& out) {
  const std::vector<ShownGroup> groups = ShownOptions(syntax, length);
  po::options_description all;
  for (const ShownGroup& group : groups) all.add(Describe(group));
  out << "velamap " << syntax.name << ": " << syntax.description << "\n\n" << all << '\n';
  const std::size_t num_more =
      NumOptions(ShownOptions(syntax, HelpLength::kAll)) - NumOptions(groups);
  if (num_more > 0) {
    out << fmt::format("{} more options: velamap {} --help_all\n", num_more, syntax.name);
  }
  out << "\nExample:\n  velamap " << syntax.name << ' ' << syntax.example << '\n';
}

}  // namespace velamap
