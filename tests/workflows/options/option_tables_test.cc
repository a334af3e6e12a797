// The options of all commands as the program has them: each is stated once, and whatever is said of
// them goes for the real parser, too.

#include <cmath>
#include <map>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/sail/sail_shape.h"
#include "importer/base/error.h"
#include "importer/detect/detection_options.h"
#include "importer/layout/code_search.h"
#include "importer/video/video_options.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/registration/registration_options.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"
#include "workflows/commands/commands.h"
#include "workflows/options/help_text.h"

namespace velamap {
namespace {

using ::testing::StartsWith;

std::vector<Option> OptionsOf(const Command& command) {
  std::vector<Option> options;
  for (const OptionGroup& group : command.syntax.groups) {
    options.insert(options.end(), group.options.begin(), group.options.end());
  }
  return options;
}

bool IsNumber(const OptionTarget& target) {
  return std::holds_alternative<int*>(target) || std::holds_alternative<double*>(target) ||
         std::holds_alternative<std::optional<double>*>(target);
}

// The message of the parser for one option of a command whose required options are all given; empty
// if it accepts the value.
std::string ErrorOf(const Command& command, const Option& option, const std::string& value) {
  std::vector<std::string> arguments = {"--" + option.name, value};
  for (const Option& other : OptionsOf(command)) {
    if (!other.required || other.name == option.name) continue;
    arguments.insert(arguments.end(), {"--" + other.name, "path_of_" + other.name});
  }
  try {
    ParseOptions(command.syntax, arguments, AllOptionNames());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::vector<std::string> ValuesBeyond(const Option& option) {
  std::vector<std::string> values;
  const bool is_whole = std::holds_alternative<int*>(option.target);
  const double step = is_whole ? 1.0 : 1e-6;
  const OptionRange& range = option.range;
  const auto text = [is_whole](double value) {
    return is_whole ? fmt::format("{:.0f}", value) : fmt::format("{}", value);
  };
  if (std::isfinite(range.min)) {
    values.push_back(text(range.min - step));
    if (range.excludes_min) values.push_back(text(range.min));
  }
  if (std::isfinite(range.max)) values.push_back(text(range.max + step));
  return values;
}

// The check that no output is an input follows from the uses of the paths.
TEST(OptionTables, EveryPathHasAUse) {
  for (const Command& command : AllCommands()) {
    for (const Option& option : OptionsOf(command)) {
      const bool is_path = option.unit.find("path") != std::string::npos;
      EXPECT_EQ(option.path_use != PathUse::kNone, is_path)
          << command.syntax.name << " --" << option.name;
    }
  }
}

TEST(OptionTables, NamesAreUniqueAndMeanTheSameEverywhere) {
  std::map<std::string, std::string> unit_of_name;
  for (const Command& command : AllCommands()) {
    std::size_t num_names = 0;
    for (const Option& option : OptionsOf(command)) {
      num_names += 1 + option.short_names.size() + option.old_names.size();
      const auto [known, is_first] = unit_of_name.emplace(option.name, option.unit);
      EXPECT_EQ(known->second, option.unit) << command.syntax.name << ' ' << option.name;
      EXPECT_FALSE(option.unit.empty()) << option.name;
      EXPECT_FALSE(option.description.empty()) << option.name;
    }
    EXPECT_EQ(OptionNames(command.syntax).size(), num_names) << command.syntax.name;
  }
}

std::size_t NumShown(const Command& command, HelpLength length) {
  std::size_t num_options = 0;
  for (const ShownGroup& group : ShownOptions(command.syntax, length)) {
    num_options += group.options.size();
  }
  return num_options;
}

TEST(OptionTables, ShortHelpOfEveryCommandIsShort) {
  for (const Command& command : AllCommands()) {
    const std::size_t num_shown = NumShown(command, HelpLength::kShort);
    EXPECT_GE(num_shown, 2u) << command.syntax.name;  // one of its own beside --project_path
    EXPECT_LE(num_shown, 16u) << command.syntax.name;
    EXPECT_EQ(NumShown(command, HelpLength::kAll), OptionsOf(command).size() + 1)
        << command.syntax.name;
  }
}

TEST(OptionTables, EveryNumberHasARangeThatHoldsItsDefault) {
  for (const Command& command : AllCommands()) {
    for (const Option& option : OptionsOf(command)) {
      if (!IsNumber(option.target)) continue;
      EXPECT_FALSE(ValuesBeyond(option).empty()) << option.name;
      EXPECT_NO_THROW(CheckRange(option, option.name)) << option.name;
    }
  }
}

TEST(OptionTables, EveryErrorNamesTheOptionThatWasGiven) {
  for (const Command& command : AllCommands()) {
    for (const Option& option : OptionsOf(command)) {
      std::vector<std::string> bad_values = ValuesBeyond(option);
      if (IsNumber(option.target)) bad_values.insert(bad_values.end(), {"nan", "inf", "1x"});
      if (std::holds_alternative<bool*>(option.target)) bad_values = {"2", "yes"};
      if (std::holds_alternative<ParsedValue>(option.target)) bad_values = {"no such thing"};
      for (const std::string& value : bad_values) {
        EXPECT_THAT(ErrorOf(command, option, value), StartsWith("--" + option.name + ": "))
            << command.syntax.name << " --" << option.name << ' ' << value;
      }
    }
  }
}

// Check() of a struct, which a caller of the library relies on, knows the same ranges and names.
template <typename Options>
void ExpectThatCheckNamesEveryNumber() {
  EXPECT_NO_THROW(Options().Check());
  Options options;
  for (const Option& option : DescribeOptions(&options).options) {
    for (const std::string& value : ValuesBeyond(option)) {
      options = {};
      if (auto* const whole = std::get_if<int*>(&option.target)) **whole = std::stoi(value);
      if (auto* const real = std::get_if<double*>(&option.target)) **real = std::stod(value);
      if (auto* const maybe = std::get_if<std::optional<double>*>(&option.target)) {
        **maybe = std::stod(value);
      }
      ExpectThrows<InputError>([&] { options.Check(); }, {"--" + option.name + ": " + value});
    }
  }
}

TEST(OptionTables, CheckNamesTheOptionsOfTheCommandLine) {
  ExpectThatCheckNamesEveryNumber<ArucoDetectionOptions>();
  ExpectThatCheckNamesEveryNumber<VideoOptions>();
  ExpectThatCheckNamesEveryNumber<CodeSearchOptions>();
  ExpectThatCheckNamesEveryNumber<RegistrationOptions>();
  ExpectThatCheckNamesEveryNumber<BundleAdjustmentOptions>();
  ExpectThatCheckNamesEveryNumber<MarkerAdjustmentOptions>();
  ExpectThatCheckNamesEveryNumber<SectionOptions>();
  ExpectThatCheckNamesEveryNumber<SurfaceOptions>();
  MarkerAdjustmentOptions options;
  options.loss_sigmas = -1;
  ExpectThrows<InputError>([&] { options.Check(); }, {"--MarkerAdjustment.loss: -1"});
}

// A value that the parser accepts, as a project file has it.
std::string GoodValue(const Option& option) {
  if (const auto number = NumberOf(option.target)) return fmt::format("{}", *number);
  if (IsNumber(option.target)) return "0.5";
  if (std::holds_alternative<bool*>(option.target)) return "1";
  if (std::holds_alternative<std::string*>(option.target)) return "text of " + option.name;
  if (option.name == "frame") return "lines";
  if (option.name == "reference_unit" || option.name == "design_unit") return "mm";
  if (option.name == "series_paths") return ".";  // has to exist
  if (option.name == "video_part") return "2/5";
  const std::string default_text = std::get<ParsedValue>(option.target).default_text;
  return default_text.empty() ? "1,2" : default_text;
}

TEST(OptionTables, OneProjectFileMayHoldEveryOptionOfEveryCommand) {
  std::map<std::string, std::map<std::string, std::string>> values_of_section;
  for (const Command& command : AllCommands()) {
    for (const Option& option : OptionsOf(command)) {
      const std::size_t dot = option.name.find('.');
      const std::string section = dot == std::string::npos ? "" : option.name.substr(0, dot);
      const std::string key = option.name.substr(dot == std::string::npos ? 0 : dot + 1);
      values_of_section[section].emplace(key, GoodValue(option));
    }
  }
  EXPECT_EQ(values_of_section[""].count("workspace_path"), 1u);
  std::string text;
  for (const auto& [section, values] : values_of_section) {
    if (!section.empty()) text += "[" + section + "]\n";
    for (const auto& [key, value] : values) text += key + "=" + value + "\n";
  }
  const TempDir temp_dir;
  const std::string file = (temp_dir / "project.ini").string();
  WriteTextFile(file, text);
  for (const Command& command : AllCommands()) {
    EXPECT_NO_THROW(ParseOptions(command.syntax, {"--project_path", file}, AllOptionNames()))
        << command.syntax.name;
  }
}

}  // namespace
}  // namespace velamap
