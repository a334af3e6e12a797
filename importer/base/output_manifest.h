// Output folders that are replaced only if they hold nothing but what velamap wrote there,
// unchanged. Layouts are made to be edited, and must not be lost to a second run.

#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace velamap {

// Contents by path relative to the folder, such as markers/marker_0012.svg.
using OutputFiles = std::map<std::string, std::string>;

// Throws InputError, naming folder and file, unless `folder` is missing, empty, or as
// WriteOutputFolder() left it.
void CheckOutputFolder(const std::filesystem::path& folder);

// Throws InputError, naming the file, if it lies in the folder and would be replaced with it.
void CheckInputOutside(const std::string& input_path, const std::filesystem::path& folder);

// Writes the files and a list of their checksums, velamap_files.txt, and replaces the folder as a
// whole. Throws InputError, naming the path, if something cannot be written.
void WriteOutputFolder(const std::filesystem::path& folder, const OutputFiles& files);

}  // namespace velamap
