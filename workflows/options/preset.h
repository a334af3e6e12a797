// --preset sets many options at once. An option that is given beside it takes precedence.

#pragma once

#include <map>
#include <string>

#include "importer/base/option.h"

namespace velamap {

enum class PresetName {
  kNone,
  kThesis,  // chapter 3 of the thesis; reconstruct/thesis/README.md compares it with the defaults
};

struct Preset {
  PresetName name = PresetName::kNone;
  std::string effect;  // once the options are set: what the preset has set; empty for kNone
};

Option PresetOption(Preset* preset);

// The values that a preset sets, by the names of the options, as on the command line.
const std::map<std::string, std::string>& PresetValues(PresetName name);

// Logs what the preset has set.
void LogPreset(const Preset& preset);

}  // namespace velamap
