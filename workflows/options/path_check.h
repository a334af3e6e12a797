// Checks the paths that a command reads and writes, by the uses of its options.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "importer/base/option.h"

namespace velamap {

// Throws InputError for a pipe or a device. Nothing happens if the path is missing. `used_by` names
// the option.
void CheckInputKind(const std::string& used_by, const std::filesystem::path& path);

// The paths in the value of `option`, with commas between them. Throws InputError, which shows
// `example`, for one that does not exist.
std::vector<std::string> PathsFromText(const std::string& text, const std::string& option,
                                       const std::string& example);

// Called once the options are set. An output that is left out goes to its default file beside
// another output. Registers the paths, so that logs and reports leave out their folders
// (importer/text/shown_text.h). Throws InputError for an input that is a pipe or a device, for an
// output that is a pipe or, where a file is needed, a folder, if the folder of an output cannot be
// written, and where CheckOutputs() (importer/base/replacement.h) does. A layout, a calibration, or
// an output at its default path other than a log may only replace a file that velamap wrote.
void CompletePaths(const std::vector<OptionGroup>& groups);

}  // namespace velamap
