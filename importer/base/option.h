// The options of the program. Each one is declared once: its name, the member that it sets, its
// unit, its range and its meaning. Each struct of options that the command line can set comes with
//
//   OptionGroup DescribeOptions(XOptions* options);
//
// from which the parser, --help, the range checks of XOptions::Check() and the names in messages
// are made.

#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace velamap {

// Target of an option whose text needs its own conversion, such as one of a fixed set of names.
struct ParsedValue {
  const void* member = nullptr;  // what `set` sets
  std::string default_text;
  // Throws InputError that begins with `option`, which says where the text was given.
  std::function<void(const std::string& text, const std::string& option)> set;
};

// The variable that an option sets. Its value at declaration is the default. A bool is given as 0
// or 1; a std::optional has no default.
using OptionTarget =
    std::variant<std::string*, int*, double*, std::optional<double>*, bool*, ParsedValue>;

// The finite numbers that an option accepts.
struct OptionRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool excludes_min = false;
};

inline OptionRange AtLeast(double min) { return {min}; }
inline OptionRange MoreThan(double min) {
  return {min, std::numeric_limits<double>::infinity(), true};
}
inline OptionRange FromTo(double min, double max) { return {min, max}; }

// What a command does with the path that an option names. The check that no output is an input
// (workflows/options/path_check.h) follows from it.
enum class PathUse {
  kNone,             // the option is not a path
  kReadsFile,        // such as a calibration or a database
  kReadsLayout,      // a layout file, and the dictionary file that it names
  kReadsPictures,    // a video, or a folder of images
  kReadsModel,       // the folder of a COLMAP model
  kReadsShape,       // a shape.csv, or the folder that holds it
  kWritesFile,       // replaces it, or adds to it
  kWritesOwnFile,    // replaces only what velamap wrote: a file that people edit, such as a layout
  kWritesFolder,     // replaces it as a whole
  kAddsToFolder,     // replaces none of its files but velamap's
  kWritesWorkspace,  // files and folders of a workspace
};

struct Option {
  std::string name;  // without dashes, such as Video.first_frame
  OptionTarget target;
  std::string unit;  // unit or kind of the value, which --help shows: m, px, path, 0|1 ...
  std::string description;
  OptionRange range = {};  // of numbers
  bool required = false;
  std::vector<std::string> short_names = {};
  std::vector<std::string> old_names = {};  // still understood, with a warning
  PathUse path_use = PathUse::kNone;
  // If the option is not given, the output goes to the file `name_beside` next to the path in
  // `*beside`.
  const std::string* beside = nullptr;
  std::string name_beside = {};
  bool is_common = false;
  // Accepted values of an option that takes one of a fixed set of names; otherwise empty.
  std::vector<std::string> choices = {};
};

Option PathOption(const std::string& name, PathUse use, std::string* path,
                  const std::string& description);

// Marks an option as common: --help lists common and required options, --help_all lists all.
Option Common(Option option);

// Sets the default of a path option: the file `name` next to `*folder`. A leading * in `name`
// stands for the stem of `*folder`: next to phone.yml, *.html is phone.html.
Option BesideIfLeftOut(Option option, const std::string* folder, const std::string& name);

struct OptionGroup {
  std::string title;
  std::vector<Option> options;
};

// The number that an option holds; nothing for other kinds and for an optional without a value.
std::optional<double> NumberOf(const OptionTarget& target);

// Throws InputError for a number beyond the option's range. The message begins with `given_as`,
// such as --Video.first_frame.
void CheckRange(const Option& option, const std::string& given_as);

// Returns "--Video.first_frame" for the option that sets `member`. The group must have such an
// option.
std::string OptionName(const OptionGroup& group, const void* member);

// Throws InputError for the first of the options that is out of its range. Takes a copy, because
// DescribeOptions() needs options that can be written to.
template <typename Options>
void CheckRanges(Options options) {
  for (const Option& option : DescribeOptions(&options).options) {
    CheckRange(option, "--" + option.name);
  }
}

// "--Video.first_frame" for &VideoOptions::first_frame.
template <typename Options, typename Member>
std::string OptionName(Member Options::*member) {
  Options options;
  return OptionName(DescribeOptions(&options), &(options.*member));
}

// Warns that `given` is an old name of `name`, which is still understood.
void WarnAboutOldName(const std::string& given, const std::string& name);

// Index of the name that is `text`. Throws InputError that begins with `option` and lists the
// names.
std::size_t FindChoice(const std::string& text, const std::vector<std::string>& names,
                       const std::string& option);

// The values of an option that takes one of a few names, in the order in which --help lists them.
template <typename Value>
using Choices = std::vector<std::pair<Value, std::string>>;

template <typename Value>
std::string ChoiceName(const Choices<Value>& choices, Value value) {
  return std::find_if(choices.begin(), choices.end(),
                      [value](const auto& choice) { return choice.first == value; })
      ->second;
}

// `old_names` of values are still understood, with a warning.
template <typename Value>
Option ChoiceOption(const std::string& name, Value* value, const Choices<Value>& choices,
                    const std::string& description, const Choices<Value>& old_names = {}) {
  std::vector<std::string> names;
  std::string unit;
  for (const auto& [choice, choice_name] : choices) {
    names.push_back(choice_name);
    unit += (unit.empty() ? "" : "|") + choice_name;
  }
  const auto set = [=](const std::string& text, const std::string& option) {
    for (const auto& [choice, old_name] : old_names) {
      if (text != old_name) continue;
      WarnAboutOldName(option + " " + text, ChoiceName(choices, choice));
      *value = choice;
      return;
    }
    *value = choices[FindChoice(text, names, option)].first;
  };
  Option option{name, ParsedValue{value, ChoiceName(choices, *value), set}, unit, description};
  option.choices = names;
  return option;
}

}  // namespace velamap
