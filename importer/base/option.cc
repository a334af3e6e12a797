#include "importer/base/option.h"

#include <cmath>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/log.h"

namespace velamap {
namespace {

std::string RangeText(const OptionRange& range) {
  if (range.excludes_min) return fmt::format("more than {}", range.min);
  if (std::isinf(range.max)) return fmt::format("{} or more", range.min);
  return fmt::format("{} to {}", range.min, range.max);
}

// Written so that a NaN is in no range.
bool Contains(const OptionRange& range, double value) {
  return std::isfinite(value) && value <= range.max &&
         (range.excludes_min ? value > range.min : value >= range.min);
}

const void* MemberOf(const OptionTarget& target) {
  struct Visitor {
    const void* operator()(const void* member) const { return member; }
    const void* operator()(const ParsedValue& value) const { return value.member; }
  };
  return std::visit(Visitor{}, target);
}

// "a, b or c".
std::string JoinChoices(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += i == 0 ? "" : i + 1 == names.size() ? " or " : ", ";
    text += names[i];
  }
  return text;
}

}  // namespace

Option PathOption(const std::string& name, PathUse use, std::string* path,
                  const std::string& description) {
  Option option{name, path, "path", description};
  option.path_use = use;
  return option;
}

Option Common(Option option) {
  option.is_common = true;
  return option;
}

Option BesideIfLeftOut(Option option, const std::string* folder, const std::string& name) {
  option.beside = folder;
  option.name_beside = name;
  return option;
}

std::optional<double> NumberOf(const OptionTarget& target) {
  struct Visitor {
    std::optional<double> operator()(const int* value) const { return *value; }
    std::optional<double> operator()(const double* value) const { return *value; }
    std::optional<double> operator()(const std::optional<double>* value) const { return *value; }
    std::optional<double> operator()(const std::string*) const { return std::nullopt; }
    std::optional<double> operator()(const bool*) const { return std::nullopt; }
    std::optional<double> operator()(const ParsedValue&) const { return std::nullopt; }
  };
  return std::visit(Visitor{}, target);
}

void CheckRange(const Option& option, const std::string& given_as) {
  const std::optional<double> value = NumberOf(option.target);
  if (!value || Contains(option.range, *value)) return;
  throw InputError(fmt::format("{}: {} is out of range; give {} ({})", given_as, *value,
                               RangeText(option.range), option.unit));
}

std::string OptionName(const OptionGroup& group, const void* member) {
  const auto option =
      std::find_if(group.options.begin(), group.options.end(),
                   [member](const Option& known) { return MemberOf(known.target) == member; });
  VELAMAP_CHECK(option != group.options.end());
  return "--" + option->name;
}

void WarnAboutOldName(const std::string& given, const std::string& name) {
  LogWarning("{}: an old name; write {}", given, name);
}

std::size_t FindChoice(const std::string& text, const std::vector<std::string>& names,
                       const std::string& option) {
  const auto name = std::find(names.begin(), names.end(), text);
  if (name == names.end()) {
    throw InputError(fmt::format("{}: '{}' is unknown; give {}", option, text, JoinChoices(names)));
  }
  return static_cast<std::size_t>(name - names.begin());
}

}  // namespace velamap
