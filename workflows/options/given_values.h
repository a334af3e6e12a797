// The values of options as they are given, on the command line or in a project file.

#pragma once

#include <map>
#include <string>
#include <vector>

#include <boost/program_options.hpp>

#include "workflows/options/option_parser.h"

namespace velamap {

// Where and how a value was given, for messages.
struct GivenValue {
  std::string text;
  std::string given_as;  // "--name" or "file: name"
};

using OptionsByName = std::map<std::string, Option>;    // under each of their names
using GivenValues = std::map<std::string, GivenValue>;  // under the first name of the option

OptionsByName IndexByName(const std::vector<OptionGroup>& groups);

boost::program_options::options_description DescribeForParsing(const OptionsByName& options);

// Adds the value of an option that is given as `name`. Throws InputError for a second one.
void AddGiven(const Option& option, const std::string& name, const GivenValue& given,
              GivenValues* values);

std::string HelpHint(const CommandSyntax& syntax);

}  // namespace velamap
