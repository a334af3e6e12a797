// No message may advise an option that the command at hand does not have, and the example of a
// layout in a README has to be one.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "exporters/formats/mesh_triangles.h"
#include "exporters/sail/section.h"
#include "exporters/surface/surface.h"
#include "importer/detect/detection_options.h"
#include "importer/layout/code_search.h"
#include "importer/layout/layout.h"
#include "importer/print/placement.h"
#include "importer/print/sheet_plan.h"
#include "importer/video/video_options.h"
#include "reconstruct/colmap/bundle_adjustment_options.h"
#include "reconstruct/problem/marker_adjustment_options.h"
#include "reconstruct/registration/registration_options.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"
#include "workflows/commands/commands.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

using Names = std::set<std::string>;

// The commands that run the code of a folder or file; of several entries the longest counts.
const std::map<std::string, Names> kCommandsOfPath = {
    {"importer/",
     {"automatic_reconstructor", "marker_importer", "clip_checker", "camera_calibrator"}},
    // What is said of a calibration, an earlier database and a prior shape: only some take these.
    {"importer/import_checks", {"automatic_reconstructor", "marker_importer"}},
    {"importer/marker_importer.cc", {"automatic_reconstructor", "marker_importer"}},
    {"importer/camera/", {"automatic_reconstructor", "marker_importer", "clip_checker"}},
    {"importer/database_merger.cc", {"database_merger"}},
    {"importer/base/",
     {"automatic_reconstructor", "marker_importer", "frame_registrator", "bundle_adjuster",
      "central_frame_sweeper", "shape_exporter", "shape_analyzer", "shape_comparer"}},
    {"importer/layout/",
     {"automatic_reconstructor", "marker_importer", "frame_registrator", "bundle_adjuster",
      "central_frame_sweeper", "shape_exporter", "shape_analyzer"}},
    {"importer/layout/code_search.cc", {"marker_generator"}},
    {"importer/layout/layout_reader.cc", {"automatic_reconstructor", "shape_comparer"}},
    {"importer/print/", {"marker_generator"}},
    {"importer/print/placement.cc", {"marker_generator", "shoot_planner"}},
    {"importer/database/",
     {"automatic_reconstructor", "marker_importer", "frame_registrator", "bundle_adjuster",
      "central_frame_sweeper"}},
    {"reconstruct/",
     {"automatic_reconstructor", "frame_registrator", "central_frame_sweeper", "clip_checker",
      "camera_calibrator"}},
    // The sweep names central frames that can be found, and is the thesis's.
    {"reconstruct/registration/frame_order.cc", {"automatic_reconstructor", "frame_registrator"}},
    {"reconstruct/registration/registration_options.cc",
     {"automatic_reconstructor", "frame_registrator"}},
    {"reconstruct/global/", {"automatic_reconstructor", "frame_registrator"}},
    {"reconstruct/model/",
     {"automatic_reconstructor", "frame_registrator", "central_frame_sweeper", "bundle_adjuster",
      "shape_exporter", "shape_analyzer", "shape_comparer"}},
    {"reconstruct/colmap/",
     {"automatic_reconstructor", "bundle_adjuster", "central_frame_sweeper"}},
    {"reconstruct/colmap/colmap_runner.cc",
     {"automatic_reconstructor", "bundle_adjuster", "central_frame_sweeper", "version"}},
    {"reconstruct/problem/",
     {"automatic_reconstructor", "bundle_adjuster", "central_frame_sweeper"}},
    {"reconstruct/adjust/",
     {"automatic_reconstructor", "bundle_adjuster", "central_frame_sweeper", "clip_checker",
      "camera_calibrator"}},
    {"exporters/", {"automatic_reconstructor", "shape_exporter"}},
    {"exporters/calibration/", {"camera_calibrator"}},
    {"exporters/compare/", {"shape_comparer"}},
    {"exporters/exchange/", {"shape_exporter"}},
    {"exporters/design/mesh_reader.cc", {"shape_comparer"}},
    {"workflows/commands/compared_shapes.cc", {"shape_comparer"}},
    {"workflows/run/adjustment.cc", {"automatic_reconstructor", "central_frame_sweeper"}},
    {"workflows/run/pipeline.cc", {"automatic_reconstructor"}},
    {"workflows/run/workspace.cc", {"automatic_reconstructor"}},
    {"workflows/run/central_frame_sweep.cc", {"central_frame_sweeper"}},
    {"workflows/plan/", {"shoot_planner"}},
    {"workflows/options/", {"automatic_reconstructor"}},
    {"workflows/options/sail_options.cc", {"automatic_reconstructor", "shape_exporter"}},
};

// Arguments of COLMAP's own programs.
const std::map<std::string, Names> kOptionsOfColmap = {
    {"reconstruct/colmap/bundle_adjustment.cc", {"input_path", "output_path"}},
    {"workflows/run/adjustment.cc", {"input_path"}},
    {"workflows/run/run_summary.cc", {"database_path", "image_path", "import_path"}},
};

// Where --name and --option stand for any option.
const std::set<std::string> kFilesOfAnyOption = {"workflows/options/given_values.h",
                                                 "workflows/options/option_parser.cc",
                                                 "workflows/commands/commands.cc"};

std::map<std::string, Names> OptionsOfCommands() {
  std::map<std::string, Names> options;
  for (const Command& command : AllCommands()) {
    Names names = OptionNames(command.syntax);
    names.insert({"help", "help_all", "version", "project_path"});
    options.emplace(command.syntax.name, names);
  }
  return options;
}

Names CommandsOf(const std::string& path, const std::map<std::string, Names>& options) {
  const std::string folder = "workflows/commands/";
  if (path.rfind(folder, 0) == 0) {
    const std::string command = fs::path(path).stem();
    if (options.count(command) > 0) return {command};
  }
  std::string longest;
  for (const auto& [prefix, commands] : kCommandsOfPath) {
    if (path.rfind(prefix, 0) == 0 && prefix.size() > longest.size()) longest = prefix;
  }
  return longest.empty() ? Names{} : kCommandsOfPath.at(longest);
}

// What stands in the quotes of a line of code, one after another.
std::string QuotedText(const std::string& line) {
  static const std::regex quoted(R"re("((?:[^"\\]|\\.)*)")re"), no_code(R"(^\s*(//|#include))");
  std::string text;
  if (line.find('"') == std::string::npos || std::regex_search(line, no_code)) return text;
  for (std::sregex_iterator it(line.begin(), line.end(), quoted), end; it != end; ++it) {
    text += (*it)[1].str() + "\n";
  }
  return text;
}

// Names of options in a text: after two dashes, or Section.name.
Names OptionsIn(const std::string& text) {
  static const std::regex name(
      R"((?:--)([A-Za-z]+(?:[._][a-z_]+)*)|\b((?:ArucoDetection|Video|Registration|)"
      R"(BundleAdjustment|MarkerAdjustment|Section|Surface)\.[a-z]+(?:_[a-z]+)*)\b(?!\*))");
  Names names;
  for (std::sregex_iterator it(text.begin(), text.end(), name), end; it != end; ++it) {
    names.insert((*it)[1].matched ? (*it)[1].str() : (*it)[2].str());
  }
  return names;
}

template <typename Options>
Names NamesOf() {
  Options options;
  Names names;
  for (const Option& option : DescribeOptions(&options).options) names.insert(option.name);
  return names;
}

// By the struct that OptionName(&Struct::member) names. Made when it is asked for: the names of
// choices, which the options refer to, need not exist while other objects are initialized.
const std::map<std::string, Names>& OptionsOfStruct() {
  static const std::map<std::string, Names> options = {
      {"ArucoDetectionOptions", NamesOf<ArucoDetectionOptions>()},
      {"BundleAdjustmentOptions", NamesOf<BundleAdjustmentOptions>()},
      {"CodeSearchOptions", NamesOf<CodeSearchOptions>()},
      {"GridPlacementOptions", NamesOf<GridPlacementOptions>()},
      {"MarkerAdjustmentOptions", NamesOf<MarkerAdjustmentOptions>()},
      {"MeshOptions", NamesOf<MeshOptions>()},
      {"PrintSheetOptions", NamesOf<PrintSheetOptions>()},
      {"RegistrationOptions", NamesOf<RegistrationOptions>()},
      {"SailPlacementOptions", NamesOf<SailPlacementOptions>()},
      {"SectionOptions", NamesOf<SectionOptions>()},
      {"SurfaceOptions", NamesOf<SurfaceOptions>()},
      {"VideoOptions", NamesOf<VideoOptions>()},
  };
  return options;
}

// The option of a member has its name, without a section, and at most lacks its unit or, as the
// rows of num_rows, its first word.
std::string OptionOfMember(const std::string& type, const std::string& member) {
  if (type + "::" + member == "CodeSearchOptions::num_codes") return "CustomDictionary.size";
  const auto options = OptionsOfStruct().find(type);
  if (options == OptionsOfStruct().end()) return type + " in OptionsOfStruct";
  for (const std::string& name : options->second) {
    const std::string last = name.substr(name.find('.') + 1);
    const std::string after_first_word = member.substr(member.find('_') + 1);
    for (const std::string& words : {member, after_first_word}) {
      if (words == last || words.rfind(last + "_", 0) == 0) return name;
    }
  }
  return type + "::" + member;
}

// Names of options in a line of code that OptionName() makes.
Names OptionsByMember(const std::string& line) {
  static const std::regex call(R"(OptionName\(&(\w+)::(\w+)\))");
  Names names;
  for (std::sregex_iterator it(line.begin(), line.end(), call), end; it != end; ++it) {
    names.insert(OptionOfMember((*it)[1].str(), (*it)[2].str()));
  }
  return names;
}

// `velamap COMMAND --option` in a text advises another command.
void TakeAdvisedCommand(const std::string& text, Names* commands) {
  static const std::regex advice("velamap ([a-z_]+) --");
  std::smatch match;
  if (std::regex_search(text, match, advice)) *commands = {match[1].str()};
}

TEST(OptionMessages, NameNoOptionThatTheCommandDoesNotHave) {
  const std::map<std::string, Names> options = OptionsOfCommands();
  int num_names = 0;
  for (const char* room : {"importer", "reconstruct", "exporters", "workflows"}) {
    const fs::path root = fs::path(VELAMAP_SOURCE_DIR);
    for (const auto& entry : fs::recursive_directory_iterator(root / room)) {
      const fs::path& extension = entry.path().extension();
      if (extension != ".cc" && extension != ".h") continue;
      const std::string path = fs::relative(entry.path(), root);
      if (kFilesOfAnyOption.count(path) > 0) continue;
      std::ifstream stream(entry.path());
      std::string before;
      for (std::string line; std::getline(stream, line);) {
        const std::string text = QuotedText(line);
        Names commands = CommandsOf(path, options);
        TakeAdvisedCommand(before + text, &commands);
        before = text.empty() ? "" : text.substr(0, text.size() - 1);
        Names names = OptionsIn(text);
        names.merge(OptionsByMember(line));
        for (const std::string& name : names) {
          const auto colmap = kOptionsOfColmap.find(path);
          if (colmap != kOptionsOfColmap.end() && colmap->second.count(name) > 0) continue;
          ++num_names;
          EXPECT_TRUE(
              std::any_of(options.begin(), options.end(),
                          [&](const auto& command) { return command.second.count(name) > 0; }))
              << path << ": no command has " << name;
          for (const std::string& command : commands) {
            EXPECT_EQ(options.at(command).count(name), 1u)
                << path << ": " << command << " has no " << name;
          }
        }
      }
    }
  }
  EXPECT_GT(num_names, 100);  // the search finds what it is for
}

TEST(OptionMessages, TheLayoutInTheReadmeIsALayout) {
  const std::string readme =
      ReadFileBytes(fs::path(VELAMAP_SOURCE_DIR) / "importer/layout/README.md");
  const std::string fence = "```", opening = fence + "yaml\n";
  const std::size_t begin = readme.find(opening) + opening.size();
  const std::size_t end = readme.find(fence, begin);
  ASSERT_LT(begin, end);
  ASSERT_NE(end, std::string::npos);
  const TempDir dir;
  const std::string path = (dir / "layout.yml").string();
  WriteTextFile(path, readme.substr(begin, end - begin));
  const Layout layout = ReadLayout(path);
  EXPECT_EQ(layout.parts.size(), 2u);
  EXPECT_EQ(layout.distances.size(), 2u);
  EXPECT_EQ(layout.known_points.size(), 4u);
}

}  // namespace
}  // namespace velamap
