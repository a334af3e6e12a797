#include "workflows/options/preset.h"

#include <filesystem>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"
#include "workflows/commands/commands.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;

struct ParsedValues {
  Preset preset;
  std::string method = "global";
  double beta = 0.5;
  double other = 1.5;
};

CommandSyntax MakePresetSyntax(ParsedValues* values) {
  return {"walker",
          "walks",
          "--preset thesis",
          {{"All",
            {PresetOption(&values->preset),
             {"Registration.method", &values->method, "name", "how"},
             {"Registration.frequency_threshold", &values->beta, "fraction", "beta", FromTo(0, 1)},
             {"Registration.other", &values->other, "m", "no value of the preset", FromTo(0, 2)}}}},
          &values->preset};
}

ParsedValues Parse(const std::vector<std::string>& arguments) {
  ParsedValues values;
  EXPECT_TRUE(ParseOptions(MakePresetSyntax(&values), arguments, {}));
  return values;
}

TEST(PresetTest, SetsWhatIsNotGivenAndSaysWhich) {
  const ParsedValues values = Parse({"--preset", "thesis"});
  EXPECT_EQ(values.method, "thesis");
  EXPECT_EQ(values.beta, 0.3);
  EXPECT_EQ(values.other, 1.5);
  EXPECT_EQ(values.preset.effect,
            "preset thesis sets --Registration.frequency_threshold 0.3 --Registration.method "
            "thesis");
}

TEST(PresetTest, WhatIsGivenWinsWhereverItIsGiven) {
  const ParsedValues typed =
      Parse({"--Registration.frequency_threshold", "0.2", "--preset", "thesis"});
  EXPECT_EQ(typed.beta, 0.2);
  EXPECT_EQ(typed.method, "thesis");
  EXPECT_THAT(typed.preset.effect,
              HasSubstr("; given instead: --Registration.frequency_threshold 0.2"));
  const TempDir temp_dir;
  const std::string file = (temp_dir / "project.ini").string();
  WriteTextFile(file, "preset=thesis\n[Registration]\nfrequency_threshold=0.4\n");
  const ParsedValues from_file = Parse({"--project_path", file});
  EXPECT_EQ(from_file.beta, 0.4);
  EXPECT_EQ(from_file.method, "thesis");
}

TEST(PresetTest, NoneAndNothingSetNothing) {
  for (const ParsedValues& values : {Parse({}), Parse({"--preset", "none"})}) {
    EXPECT_EQ(values.method, "global");
    EXPECT_EQ(values.preset.effect, "");
  }
  ParsedValues values;
  EXPECT_THROW(ParseOptions(MakePresetSyntax(&values), {"--preset", "theses"}, {}), InputError);
}

// A name that no command has any more would silently be left out.
TEST(PresetTest, EveryValueIsAnOptionOfACommandThatHasThePreset) {
  std::set<std::string> names;
  int num_commands = 0;
  for (const Command& command : AllCommands()) {
    const std::set<std::string> own = OptionNames(command.syntax);
    EXPECT_EQ(own.count("preset") == 1, command.syntax.preset != nullptr) << command.syntax.name;
    if (command.syntax.preset == nullptr) continue;
    ++num_commands;
    names.insert(own.begin(), own.end());
  }
  EXPECT_EQ(num_commands, 6);
  for (const auto& [name, value] : PresetValues(PresetName::kThesis)) {
    EXPECT_EQ(names.count(name), 1u) << name;
  }
}

// The table says which section of the thesis each value comes from.
TEST(PresetTest, TheReadmeHasEveryValueOfThePreset) {
  std::istringstream readme(
      ReadFileBytes(std::filesystem::path(VELAMAP_SOURCE_DIR) / "reconstruct/thesis/README.md"));
  std::string rows;
  for (std::string line; std::getline(readme, line);) {
    if (line.rfind("| 3.", 0) == 0 || line.rfind("| 4.", 0) == 0) rows += line + "\n";
  }
  for (const auto& [name, value] : PresetValues(PresetName::kThesis)) {
    const std::string last_name = name.substr(name.find('.') + 1);
    EXPECT_THAT(rows, HasSubstr("`" + last_name + " " + value + "`"));
  }
}

}  // namespace
}  // namespace velamap
