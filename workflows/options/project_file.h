// Reads the project file that --project_path names.

#pragma once

#include <set>
#include <string>

#include "workflows/options/given_values.h"

namespace velamap {

inline constexpr const char* kProjectPath = "project_path";

// The values of the command's options, without those of other commands (`known_names`). Throws
// InputError as ParseOptions() does.
GivenValues ReadProjectFile(const CommandSyntax& syntax, const OptionsByName& options,
                            const std::string& path, const std::set<std::string>& known_names);

}  // namespace velamap
