// Texts that are meant to be sent around, such as logs and the report: they name files without
// their folders, which are private, unless the user has asked for them.

#pragma once

#include <filesystem>
#include <string>

namespace velamap {

// Whether WithoutFolders() leaves the folders there. Not at the start of the program.
void ShowFolders(bool show);

// Names a file or folder that texts may mention. WithoutFolders() recognises the folders above it
// even where their names hold spaces.
void MentionPath(const std::filesystem::path& path);

// The text with the last name only of each absolute path: of one that begins as a mentioned path
// does, and of each word that begins with a slash.
std::string WithoutFolders(const std::string& text);

}  // namespace velamap
