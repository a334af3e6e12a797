#include "workflows/options/project_file.h"

#include <sstream>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/text/nearest_name.h"
#include "importer/text/text_file.h"

namespace velamap {
namespace {

namespace po = boost::program_options;

// Empty for a name without a section.
std::string SectionOf(const std::string& name) {
  const std::size_t dot = name.find('.');
  return dot == std::string::npos ? "" : name.substr(0, dot);
}

// What is wrong with a key that neither this command nor another one has.
std::string DescribeUnknownKey(const OptionsByName& options, std::set<std::string> known_names,
                               const std::string& name) {
  for (const auto& [known_name, option] : options) known_names.insert(known_name);
  std::set<std::string> sections;
  for (const std::string& known_name : known_names) sections.insert(SectionOf(known_name));
  const std::string section = SectionOf(name);
  if (sections.count(section) > 0) {
    return fmt::format("unknown key {}; {}", name,
                       DidYouMean(name, {known_names.begin(), known_names.end()}));
  }
  sections.erase("");
  return fmt::format("unknown section [{}] of the key {}; {}", section, name,
                     DidYouMean(section, {sections.begin(), sections.end()}));
}

}  // namespace

GivenValues ReadProjectFile(const CommandSyntax& syntax, const OptionsByName& options,
                            const std::string& path, const std::set<std::string>& known_names) {
  const std::string text = ReadTextFile(path, fmt::format("project file (--{})", kProjectPath));
  if (text.find('\0') != std::string::npos) {
    throw InputError(path + ": a zero byte, which no project file holds; save it as UTF-8");
  }
  std::istringstream stream(text);
  GivenValues values;
  try {
    constexpr bool kAllowUnregistered = true;
    const po::options_description description = DescribeForParsing(options);
    for (const auto& given :
         po::parse_config_file(stream, description, kAllowUnregistered).options) {
      const std::string& name = given.string_key;
      if (given.unregistered && known_names.count(name) > 0) continue;
      if (name == kProjectPath) {
        throw InputError(fmt::format(
            "{}: {}: a project file cannot name another one; remove this key", path, name));
      }
      if (given.unregistered) {
        throw InputError(fmt::format(
            "{}: {}{}", path, DescribeUnknownKey(options, known_names, name), HelpHint(syntax)));
      }
      AddGiven(options.at(name), name, {given.value.front(), path + ": " + name}, &values);
    }
  } catch (const po::error& error) {
    throw InputError(
        fmt::format("{}: {}; expected key=value lines, and [Section] before the keys of a section",
                    path, error.what()));
  }
  return values;
}

}  // namespace velamap
