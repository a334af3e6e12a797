#include "workflows/options/option_parser.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/text/nearest_name.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"
#include "workflows/commands/commands.h"
#include "workflows/options/help_text.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

enum class Gait { kWalk, kTrot };

struct Values {
  std::string text = "default";
  int count = 7;
  double length_m = 0.25;
  std::optional<double> maybe_m;
  bool yes = false;
  std::string path;
  Gait gait = Gait::kTrot;
};

CommandSyntax MakeSyntax(Values* values) {
  Option path = {"path", &values->path, "path", "where to"};
  path.required = true;
  path.short_names = {"p"};
  path.old_names = {"goal"};
  return {
      "walker",
      "walks",
      "--path x",
      {{"First", {path, {"text", &values->text, "", "words"}}},
       {"Second",
        {{"Walk.count", &values->count, "steps", "how many", AtLeast(0)},
         {"Walk.max_num_steps", &values->count, "steps", "at most", AtLeast(0)},
         {"Walk.length", &values->length_m, "m", "how long", MoreThan(0)},
         {"Walk.maybe", &values->maybe_m, "m", "perhaps", FromTo(-1, 1)},
         {"Walk.yes", &values->yes, "0|1", "whether"},
         ChoiceOption("Walk.gait", &values->gait, {{Gait::kWalk, "walk"}, {Gait::kTrot, "trot"}},
                      "how", {{Gait::kWalk, "stroll"}})}}}};
}

std::string ErrorOf(const std::vector<std::string>& arguments) {
  Values values;
  try {
    ParseOptions(MakeSyntax(&values), arguments, AllOptionNames());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(OptionParserTest, LeavesDefaultsAlone) {
  Values values;
  ASSERT_TRUE(ParseOptions(MakeSyntax(&values), {"--path", "p"}, {}));
  EXPECT_EQ(values.path, "p");
  EXPECT_EQ(values.text, "default");
  EXPECT_EQ(values.count, 7);
  EXPECT_EQ(values.length_m, 0.25);
  EXPECT_FALSE(values.maybe_m.has_value());
}

TEST(OptionParserTest, ReadsAllKindsOfValues) {
  Values values;
  ASSERT_TRUE(ParseOptions(MakeSyntax(&values),
                           {"--path=a b", "--Walk.count", "3", "--Walk.length", "1e-3",
                            "--Walk.maybe", "-1", "--Walk.yes", "1", "--Walk.gait", "walk"},
                           {}));
  EXPECT_EQ(values.path, "a b");
  EXPECT_EQ(values.count, 3);
  EXPECT_EQ(values.length_m, 1e-3);
  EXPECT_EQ(values.maybe_m, -1.0);
  EXPECT_TRUE(values.yes);
  EXPECT_EQ(values.gait, Gait::kWalk);
}

TEST(OptionParserTest, RefusesValuesBeyondTheRange) {
  const auto error_of = [](const std::string& name, const std::string& value) {
    return ErrorOf({"--path", "p", name, value});
  };
  EXPECT_EQ(error_of("--Walk.count", "-1"),
            "--Walk.count: -1 is out of range; give 0 or more (steps)");
  EXPECT_EQ(error_of("--Walk.length", "0"),
            "--Walk.length: 0 is out of range; give more than 0 (m)");
  EXPECT_EQ(error_of("--Walk.maybe", "1.5"), "--Walk.maybe: 1.5 is out of range; give -1 to 1 (m)");
  EXPECT_EQ(error_of("--Walk.length", "0,5"),
            "--Walk.length: '0,5' is not a number, or is too large; write a decimal point: 0.5");
  EXPECT_EQ(error_of("--Walk.count", "1,5"),
            "--Walk.count: '1,5' is not a whole number, or is too large");
  EXPECT_EQ(error_of("--Walk.gait", "run"), "--Walk.gait: 'run' is unknown; give walk or trot");
}

TEST(OptionParserTest, UnderstandsShortAndOldNamesButOneAtATime) {
  for (const char* name : {"--path", "--p", "--goal"}) {
    Values values;
    ASSERT_TRUE(ParseOptions(MakeSyntax(&values), {name, "x", "--Walk.gait", "stroll"}, {}));
    EXPECT_EQ(values.path, "x");
    EXPECT_EQ(values.gait, Gait::kWalk);
  }
  EXPECT_EQ(ErrorOf({"--p", "x", "--path", "x"}),
            "--p and --path: two names of one option; give one of them");
  EXPECT_THAT(ErrorOf({"--goal", "x", "--p", "y"}), HasSubstr("--goal and --p"));
}

TEST(OptionParserTest, UnknownOptionNamesNearestAndHelp) {
  const std::string error = ErrorOf({"--path", "p", "--Walk.cuont", "3"});
  EXPECT_THAT(error, HasSubstr("--Walk.cuont"));
  EXPECT_THAT(error, HasSubstr("did you mean --Walk.count?"));
  EXPECT_THAT(error, HasSubstr("velamap walker --help"));
}

TEST(OptionParserTest, SuggestsTheNameThatLacksAWord) {
  EXPECT_THAT(ErrorOf({"--path", "p", "--Walk.max_steps", "3"}),
              HasSubstr("did you mean --Walk.max_num_steps?"));
}

TEST(OptionParserTest, SectionMayBeForgottenInSuggestions) {
  EXPECT_THAT(ErrorOf({"--path", "p", "--count", "3"}), HasSubstr("did you mean --Walk.count?"));
}

TEST(OptionParserTest, RefusesBadValues) {
  EXPECT_THAT(ErrorOf({"--path", "p", "--Walk.count", "3x"}), HasSubstr("--Walk.count: '3x'"));
  EXPECT_THAT(ErrorOf({"--path", "p", "--Walk.count", "99999999999"}), HasSubstr("--Walk.count"));
  EXPECT_THAT(ErrorOf({"--path", "p", "--Walk.length", "nan"}), HasSubstr("--Walk.length: 'nan'"));
  EXPECT_THAT(ErrorOf({"--path", "p", "--Walk.length", "1,5"}), HasSubstr("--Walk.length: '1,5'"));
  EXPECT_THAT(ErrorOf({"--path", "p", "--Walk.yes", "true"}), HasSubstr("0 (no) or 1 (yes)"));
  EXPECT_THAT(ErrorOf({"--path", "p", "--Walk.yes"}), HasSubstr("Walk.yes"));
}

TEST(OptionParserTest, RefusesMissingRepeatedAndStrayArguments) {
  EXPECT_THAT(ErrorOf({}), HasSubstr("--path: missing"));
  EXPECT_THAT(ErrorOf({"--path", ""}), HasSubstr("--path"));
  EXPECT_THAT(ErrorOf({"--path", "p", "--path", "q"}), HasSubstr("--path: given twice"));
  EXPECT_THAT(ErrorOf({"--path", "p", "q"}), HasSubstr("'q'"));
}

TEST(OptionParserTest, ALackingValueIsNamedWhateverFollows) {
  EXPECT_EQ(ErrorOf({"--path", "--text", "x"}),
            "--path: needs a value, and --text looks like the next option; see velamap walker "
            "--help_all");
  EXPECT_THAT(ErrorOf({"--path", "--txet", "x"}), HasSubstr("--path: needs a value, and --txet"));
  EXPECT_EQ(ErrorOf({"--path=--odd"}), "");
}

TEST(OptionParserTest, APathIsNotEmpty) {
  Values values;
  CommandSyntax syntax = MakeSyntax(&values);
  syntax.groups[0].options[1].path_use = PathUse::kReadsFile;
  for (const auto& given : std::vector<std::vector<std::string>>{{"--text", ""}, {"--text="}}) {
    std::vector<std::string> arguments = {"--path", "p"};
    arguments.insert(arguments.end(), given.begin(), given.end());
    try {
      ParseOptions(syntax, arguments, {});
      ADD_FAILURE() << "no error";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::StartsWith("--text: needs a value"));
    }
  }
  syntax.groups[0].options[0].path_use = PathUse::kReadsFile;
  try {
    ParseOptions(syntax, {"--path", ""}, {});
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::EndsWith("give a path"));  // it is required
  }
}

TEST(OptionParserTest, TypedNamesAreThoseOfTheCommandLine) {
  const TempDir temp_dir;
  const std::string file = (temp_dir / "project.ini").string();
  WriteTextFile(file, "[Walk]\ncount=3\n");
  Values values;
  TypedNames typed;
  CommandSyntax syntax = MakeSyntax(&values);
  syntax.typed = &typed;
  ASSERT_TRUE(
      ParseOptions(syntax, {"--goal", "p", "--Walk.length", "0.25", "--project_path", file}, {}));
  EXPECT_EQ(values.count, 3);
  EXPECT_EQ(typed, (TypedNames{"path", "Walk.length", "project_path"}));
}

TEST(OptionParserTest, AbbreviationsAreNoOptions) {
  EXPECT_THAT(ErrorOf({"--pat", "p"}), HasSubstr("--pat: unknown option"));
}

TEST(OptionParserTest, CommandLineWinsOverProjectFile) {
  const TempDir temp_dir;
  const std::string file = (temp_dir / "project.ini").string();
  WriteTextFile(file, "path=from file\ntext = words\n# a comment\n[Walk]\ncount=3\nlength=0.5\n");
  Values values;
  ASSERT_TRUE(ParseOptions(MakeSyntax(&values), {"--Walk.count", "4", "--project_path", file}, {}));
  EXPECT_EQ(values.path, "from file");
  EXPECT_EQ(values.text, "words");
  EXPECT_EQ(values.count, 4);
  EXPECT_EQ(values.length_m, 0.5);
}

TEST(OptionParserTest, ProjectFileErrorsNameFileAndKey) {
  const TempDir temp_dir;
  const std::string file = (temp_dir / "project.ini").string();
  const std::vector<std::string> arguments = {"--path", "p", "--project_path", file};
  EXPECT_THAT(ErrorOf(arguments), HasSubstr(file));

  WriteTextFile(file, "[Walk]\ncuont=3\n");
  EXPECT_THAT(ErrorOf(arguments), HasSubstr(file + ": unknown key Walk.cuont; did you mean"));
  WriteTextFile(file, "[Wlak]\ncount=3\n");
  EXPECT_THAT(
      ErrorOf(arguments),
      HasSubstr(file + ": unknown section [Wlak] of the key Wlak.count; did you mean Walk?"));
  WriteTextFile(file, "[Walk]\nhelp=3\nheight=1\n");
  EXPECT_THAT(ErrorOf(arguments), Not(HasSubstr("did you mean help")));
  WriteTextFile(file, "[Walk]\ncount=three\n");
  EXPECT_THAT(ErrorOf(arguments), HasSubstr(file + ": Walk.count: 'three'"));
  WriteTextFile(file, "no equals sign\n");
  EXPECT_THAT(ErrorOf(arguments), HasSubstr(file));
  WriteTextFile(file, "text=a\ntext=b\n");
  EXPECT_THAT(ErrorOf(arguments), HasSubstr(file));
}

TEST(OptionParserTest, ProjectFileMayBeginWithAByteOrderMark) {
  const TempDir temp_dir;
  const std::string file = (temp_dir / "project.ini").string();
  WriteTextFile(file, "\xef\xbb\xbfpath=a\n");
  Values values;
  ASSERT_TRUE(ParseOptions(MakeSyntax(&values), {"--project_path", file}, {}));
  EXPECT_EQ(values.path, "a");
}

TEST(OptionParserTest, ProjectFileMayGiveAnOptionOnceOnly) {
  const TempDir temp_dir;
  const std::string file = (temp_dir / "project.ini").string();
  WriteTextFile(file, "path=a\ngoal=b\n");
  EXPECT_THAT(ErrorOf({"--project_path", file}), HasSubstr("two names of one option"));
  Values values;
  WriteTextFile(file, "goal=from file\n");
  ASSERT_TRUE(ParseOptions(MakeSyntax(&values), {"--p", "typed", "--project_path", file}, {}));
  EXPECT_EQ(values.path, "typed");
}

TEST(OptionParserTest, ProjectFileMayHoldOptionsOfOtherCommands) {
  const TempDir temp_dir;
  const std::string file = (temp_dir / "project.ini").string();
  for (const std::string& name : AllOptionNames()) {
    if (name == "path") continue;
    const std::size_t dot = name.find('.');
    WriteTextFile(file, dot == std::string::npos
                            ? name + "=3\n"
                            : "[" + name.substr(0, dot) + "]\n" + name.substr(dot + 1) + "=3\n");
    EXPECT_EQ(ErrorOf({"--path", "p", "--project_path", file}), "") << name;
  }
}

TEST(OptionParserTest, HelpShowsDefaultsUnitsAndExample) {
  Values values;
  const CommandSyntax syntax = MakeSyntax(&values);
  EXPECT_FALSE(ParseOptions(syntax, {"--Walk.count", "wrong", "--help"}, {}));
  std::ostringstream out;
  PrintHelp(syntax, HelpLength::kAll, out);
  EXPECT_THAT(out.str(), HasSubstr("--Walk.length m (=0.25)"));
  EXPECT_THAT(out.str(), HasSubstr("--Walk.gait walk|trot (=trot)"));
  EXPECT_THAT(out.str(), HasSubstr("--path path"));
  EXPECT_THAT(out.str(), HasSubstr("in short --p"));
  EXPECT_THAT(out.str(), HasSubstr("velamap walker --path x"));
}

TEST(OptionParserTest, ShortHelpShowsWhatIsRequiredOrCommonAndCountsTheRest) {
  Values values;
  CommandSyntax syntax = MakeSyntax(&values);
  syntax.groups[1].options[2] = Common(syntax.groups[1].options[2]);
  std::ostringstream out;
  PrintHelp(syntax, HelpLength::kShort, out);
  for (const char* shown : {"--path path", "--Walk.length m", "--project_path path"}) {
    EXPECT_THAT(out.str(), HasSubstr(shown));
  }
  for (const char* hidden : {"--text", "--Walk.count", "--Walk.gait"}) {
    EXPECT_THAT(out.str(), Not(HasSubstr(hidden)));
  }
  EXPECT_THAT(out.str(), HasSubstr("6 more options: velamap walker --help_all"));
  syntax.groups = {{"First", {syntax.groups[0].options[0]}},
                   {"Second", {syntax.groups[0].options[1]}}};
  std::ostringstream without_group;
  PrintHelp(syntax, HelpLength::kShort, without_group);
  EXPECT_THAT(without_group.str(), Not(HasSubstr("Second")));
}

TEST(OptionParserTest, HelpIsAskedForInTwoLengths) {
  EXPECT_EQ(RequestedHelp({"--path", "p"}), std::nullopt);
  EXPECT_EQ(RequestedHelp({"--path", "p", "-h"}), HelpLength::kShort);
  EXPECT_EQ(RequestedHelp({"--help"}), HelpLength::kShort);
  EXPECT_EQ(RequestedHelp({"--help", "--help_all"}), HelpLength::kAll);
}

TEST(NearestNameTest, SuggestsOnlyWhatIsNear) {
  const std::vector<std::string> names = {"marker_importer", "help", "Registration.num_frames",
                                          "Registration.max_num_frames"};
  EXPECT_EQ(NearestName("Registration.max_frames", names), "Registration.max_num_frames");
  EXPECT_EQ(NearestName("marker_imprter", names), "marker_importer");
  EXPECT_EQ(NearestName("hepl", names), "help");
  EXPECT_EQ(NearestName("Wlak", {"Plan", "Walk"}), "Walk");
  EXPECT_EQ(NearestName("path_image", {"path_camera", "image_path"}), "image_path");
  EXPECT_EQ(NearestName("zzzzzz", names), "");
  EXPECT_EQ(NearestName("backend", names), "");
  EXPECT_EQ(NearestName("SurfaceGrid.columns", names), "");
  EXPECT_EQ(NearestName("help", {"help"}), "");
}

}  // namespace
}  // namespace velamap
