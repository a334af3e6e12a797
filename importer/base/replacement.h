// What velamap may replace, and what it may not: the one rule for all commands.
//
//   file     one that the user has named as output, unless it is also an input or the output of
//            another option, possibly under another name. Under a default name, and for layouts and
//            calibrations, which people write and edit, only a file that velamap wrote
//            (CheckOwnFile)
//   folder   as a whole, unless it is write-protected, if velamap wrote every file in it and nobody
//            has changed one since. Each folder that velamap writes holds a record of its files,
//            kFolderRecord
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

// The first line of a layout that velamap proposes, without the "# " of a comment.
inline constexpr char kProposedLayout[] = "Proposed by velamap clip_checker.";

// The text of the record for what is in `folder` now; empty if it holds no files.
std::string MakeFolderRecord(const std::filesystem::path& folder);

// Throws InputError, naming the path and the first such file, if the folder or a sub-folder holds a
// file that velamap did not write there, or that was changed afterwards. It may also hold tables
// and logs that commands write beside the folders of their results. Does nothing if the path is
// missing.
void CheckReplaceableFolder(const std::filesystem::path& path);

// Whether the path is a file that begins as one of velamap's tables, pages, calibrations, proposed
// layouts or logs and was not changed after velamap sealed it. A layout without a seal is the
// user's.
bool IsOwnFile(const std::filesystem::path& path);

// Throws InputError, which begins with `used_by`, if the path is a file with content that is not
// velamap's own. Nothing happens if it is missing.
void CheckOwnFile(const std::string& used_by, const std::filesystem::path& path);

// `text` and a last line, a comment, with the hash of it. The line begins with `comment_begin` and
// ends with `comment_end`, such as "# " and "".
std::string WithSeal(const std::string& text, const std::string& comment_begin,
                     const std::string& comment_end);

// Whether the path is the folder or lies in it; links count as what they lead to.
bool IsInside(const std::filesystem::path& path, const std::filesystem::path& folder);

// A path that a command reads or writes, and on whose behalf.
struct UsedPath {
  std::string used_by;  // such as --csv_path, for messages
  std::filesystem::path path;
  bool is_replaced_folder = false;  // outputs only: a folder that is replaced as a whole
  bool replaces_only_own = false;   // outputs only: a file that CheckOwnFile() has to allow
};

// Throws InputError, naming both options, if an output is one of the inputs or another output, also
// through links, or lies in a folder that is replaced, if such a folder holds an input or is not
// replaceable, or if a file is not velamap's where only such a one may be replaced.
void CheckOutputs(const std::vector<UsedPath>& inputs, const std::vector<UsedPath>& outputs);

// Throws InputError that begins with `where` if the name of an image leads out of the folder of
// images: an absolute one, or one with "..".
void CheckImageName(const std::string& name, const std::string& where);

// Throws InputError, naming the path, for a file or folder that is write-protected: nobody may
// write it, or not this user. The check is needed because replacing a file takes no permission to
// write to it. Nothing happens if it is missing.
void CheckNotProtected(const std::filesystem::path& path);

// Where output is written until it is finished: beside its place, under a name that no other
// process or thread uses. Removes what killed runs have left there (RemoveUnfinished()), once per
// folder.
std::filesystem::path TemporarySibling(const std::filesystem::path& path);

// The path that unfinished output will have when it and the folders that hold it have been renamed.
// Any other path stays as it is. Messages name this one.
std::filesystem::path FinalPath(const std::filesystem::path& path);

// Removes unfinished output of killed runs on this machine from the folder: files whose name holds
// the id of a process that no longer runs. Nothing happens if the folder is missing.
void RemoveUnfinished(const std::filesystem::path& folder);

}  // namespace velamap
