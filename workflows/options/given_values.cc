#include "workflows/options/given_values.h"

#include <algorithm>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

namespace po = boost::program_options;

std::vector<std::string> NamesOf(const Option& option) {
  std::vector<std::string> names = {option.name};
  names.insert(names.end(), option.short_names.begin(), option.short_names.end());
  names.insert(names.end(), option.old_names.begin(), option.old_names.end());
  return names;
}

}  // namespace

OptionsByName IndexByName(const std::vector<OptionGroup>& groups) {
  OptionsByName options;
  for (const OptionGroup& group : groups) {
    for (const Option& option : group.options) {
      for (const std::string& name : NamesOf(option)) options.emplace(name, option);
    }
  }
  return options;
}

po::options_description DescribeForParsing(const OptionsByName& options) {
  po::options_description description;
  for (const auto& [name, option] : options) {
    description.add_options()(name.c_str(), po::value<std::string>(), "");
  }
  return description;
}

void AddGiven(const Option& option, const std::string& name, const GivenValue& given,
              GivenValues* values) {
  const auto [earlier, is_first] = values->emplace(option.name, given);
  const std::string& given_before = earlier->second.given_as;
  if (!is_first && given_before == given.given_as) {
    throw InputError(fmt::format("{}: given twice; give it once", given.given_as));
  }
  if (!is_first) {
    throw InputError(fmt::format("{} and {}: two names of one option; give one of them",
                                 given_before, given.given_as));
  }
  const std::vector<std::string>& old_names = option.old_names;
  if (std::find(old_names.begin(), old_names.end(), name) != old_names.end()) {
    WarnAboutOldName(given.given_as, "--" + option.name);
  }
}

std::string HelpHint(const CommandSyntax& syntax) {
  return fmt::format("see velamap {} --help_all", syntax.name);
}

}  // namespace velamap
