// Text that people share, such as logs and the report. It names files without their folders, which
// are private, unless the user has asked for them.

#pragma once

#include <filesystem>
#include <string>

namespace velamap {

// Sets whether StripFolders() leaves the folders in; at the start of the program it does not.
void ShowFolders(bool show);

// Registers a file or folder that texts may mention, so that StripFolders() recognizes the
// folders above it even where their names hold spaces.
void RegisterPrivatePath(const std::filesystem::path& path);

// Returns the text with every absolute path reduced to its file name. Every word that begins with a
// slash counts as a path. Folders of registered paths are recognized even with spaces in them.
std::string StripFolders(const std::string& text);

}  // namespace velamap
