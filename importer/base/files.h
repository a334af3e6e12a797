// The file system: paths, folders and files. A failure is an InputError that names the path, such
// as "a/b: cannot be read: File name too long". Only this file and atomic_output call
// std::filesystem, whose own exceptions would end the program as a broken invariant.

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace velamap {

class FileLock;

// Links are followed. Returns false if nothing is there; throws if that cannot be determined,
// because of missing permissions or a path that is too long.
bool Exists(const std::filesystem::path& path);
bool IsFolder(const std::filesystem::path& path);
bool IsRegularFile(const std::filesystem::path& path);
bool IsPipe(const std::filesystem::path& path);

// Whether the path itself is a link, wherever that leads.
bool IsLink(const std::filesystem::path& path) noexcept;

std::uintmax_t FileSize(const std::filesystem::path& path);

// Returns the absolute path without "." and "..". Links are not resolved, so that messages show the
// path as the user knows it.
std::filesystem::path AbsolutePath(const std::filesystem::path& path);

// Where the file is, or will be when it is written: all links are followed, including dangling
// ones. Used to compare outputs with inputs, and to write through links instead of replacing them.
std::filesystem::path CanonicalPath(const std::filesystem::path& path);

// AbsolutePath() without the trailing slash, so that its parent is the folder that holds it.
std::filesystem::path AbsoluteFolder(const std::filesystem::path& path);

// The extension of a path with its dot, in lower case; empty without one.
std::string LowerExtension(const std::filesystem::path& path);

// Everything in the folder, sorted by name.
std::vector<std::filesystem::path> FolderEntries(const std::filesystem::path& folder);

// Returns all files in the folder and its sub-folders, in no particular order. Pipes, devices and
// dangling links are included, so that the caller can report them. Links are followed, but each
// folder is visited once, under its real path if that lies in this tree. Files and folders whose
// name starts with a dot are left out.
std::vector<std::filesystem::path> FilesBelow(const std::filesystem::path& folder);

// Creates the folder and its missing parents; nothing happens if it is there.
void CreateFolders(const std::filesystem::path& path);

// Whether both paths lead to one file, which has several names or is reached through links. Returns
// false unless both exist.
bool IsSameFile(const std::filesystem::path& path1, const std::filesystem::path& path2);

// FNV-1a, 64 bit: short, and the same on every machine. `hash` continues an earlier one.
std::uint64_t Hash(std::string_view bytes, std::uint64_t hash = 0xcbf29ce484222325u);

std::uint64_t HashOfFile(const std::filesystem::path& path);

// Writes to an open file or pipe. Returns false, with the reason in errno, if not everything can be
// written.
bool WriteAll(int file, const void* data, std::size_t size);

// Removes a file, or a folder with everything in it. What cannot be removed stays.
void RemoveAll(const std::filesystem::path& path) noexcept;

// Removes a file or an empty folder; a folder that holds something stays.
void RemoveFileOrEmptyFolder(const std::filesystem::path& path) noexcept;

// A new folder in TMPDIR, or in /tmp if that is unset or empty. It is removed with everything in it
// by the destructor or, if the run is killed, by the next run.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::unique_ptr<FileLock> lock_;  // shows other runs that it is in use
};

}  // namespace velamap
