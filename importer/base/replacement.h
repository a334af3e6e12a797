// What velamap may replace, and what it may not: the one rule for all commands.
//
//   file     An output that the user has named is replaced, unless it is also an input or another
//            output, possibly under another name. At default paths, and for layouts and
//            calibrations, which people edit, only files that velamap wrote are replaced
//            (CheckOwnFile()).
//   folder   Replaced as a whole, if velamap wrote every file in it, nobody has changed one since,
//            and it is not write-protected. Each folder that velamap writes holds a record of its
//            files (kFolderRecord).
//   picture  In a folder of pictures, only frames that velamap wrote are replaced
//            (video/written_frame.h).
//
// Image names that are read from files must not lead out of their folder (CheckImageName()).

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

// Returns `text` with a seal: a last line that is a comment and holds the hash of `text`. The line
// begins with `comment_begin` and ends with `comment_end`, such as "# " and "".
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

// Throws InputError that names the option, if an output
//
//   - is one of the inputs or another output, also through links (names both options)
//   - is a folder to be replaced that holds an input or another output (names both options)
//   - is a folder to be replaced that is not replaceable (CheckReplaceableFolder())
//   - is a write-protected file
//   - is a file that velamap did not write, where only velamap's own may be replaced
void CheckOutputs(const std::vector<UsedPath>& inputs, const std::vector<UsedPath>& outputs);

// Throws InputError that begins with `where` if the name of an image leads out of the folder of
// images: an absolute one, or one with "..".
void CheckImageName(const std::string& name, const std::string& where);

// Throws InputError, naming the path, for a file or folder that is write-protected: nobody may
// write it, or not this user. The check is needed because replacing a file takes no permission to
// write to it. Nothing happens if it is missing.
void CheckNotProtected(const std::filesystem::path& path);

// Returns the path at which output is written until it is finished: in the same folder, under a
// name that no other process or thread uses. Removes what killed runs have left in the folder
// (RemoveUnfinished()), once per folder.
std::filesystem::path TemporarySibling(const std::filesystem::path& path);

// The path that unfinished output will have when it and the folders that hold it have been renamed.
// Any other path stays as it is. Messages name this one.
std::filesystem::path FinalPath(const std::filesystem::path& path);

// Removes unfinished output of killed runs on this machine from the folder: files whose name holds
// the id of a process that no longer runs. Nothing happens if the folder is missing.
void RemoveUnfinished(const std::filesystem::path& folder);

}  // namespace velamap
