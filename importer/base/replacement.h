// What velamap may replace, and what it may not: the one rule for all commands.
//
//   file     one that the user has named as output, unless it is an input or the output of another
//            option, under whatever name
//   folder   as a whole, if velamap wrote every file in it and nobody has changed one since. Each
//            folder that velamap writes holds a record of its files, kFolderRecord
//   picture  in a folder of pictures: only frames that velamap wrote (video/written_frame.h)
//
// Names that come from files must not lead to other places: CheckImageName().

#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace velamap {

// In a folder that velamap writes: one line for each file directly in it, with the hash of its
// content.
inline constexpr char kFolderRecord[] = ".velamap";

// The text of the record for what is in `folder` now; empty if it holds no files.
std::string MakeFolderRecord(const std::filesystem::path& folder);

// Throws InputError, naming the path and the first such file, if the folder holds a file that
// velamap did not write there, or that was changed afterwards; the same for its sub-folders.
// Nothing happens if the path is missing.
void CheckReplaceableFolder(const std::filesystem::path& path);

// Whether the path is the folder or lies in it; links count as what they lead to.
bool IsInside(const std::filesystem::path& path, const std::filesystem::path& folder);

// A path that a command reads or writes, and on whose behalf.
struct UsedPath {
  std::string used_by;  // such as --csv_path, for messages
  std::filesystem::path path;
  bool is_replaced_folder = false;  // outputs only: a folder that is replaced as a whole
};

// Throws InputError, naming both options, if an output is one of the inputs or another output, also
// through links, or lies in a folder that is replaced, or if such a folder holds an input or is not
// replaceable.
void CheckOutputs(const std::vector<UsedPath>& inputs, const std::vector<UsedPath>& outputs);

// Throws InputError that begins with `where` if the name of an image leads out of the folder of
// images: an absolute one, or one with "..".
void CheckImageName(const std::string& name, const std::string& where);

// Output that is not finished has such a name, which no other process or thread of this machine
// uses, beside its place.
std::string TemporaryName(const std::string& name);

// The name that unfinished output will have, and other names as they are.
std::string FinalName(const std::string& name);

// Removes what an interrupted run has left unfinished in the folder. For folders that no other run
// writes to now. Nothing happens if the folder is missing.
void RemoveUnfinished(const std::filesystem::path& folder);

}  // namespace velamap
