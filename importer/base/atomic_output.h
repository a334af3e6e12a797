// Writes output atomically: to a temporary sibling that replaces the target by a rename once it is
// complete. Symbolic links are followed, so the link stays and its target is replaced.
// Write-protected files are never replaced. The next run that writes to the folder removes what a
// killed run left there.

#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace velamap {

// A fresh folder beside `path`. Commit() adds the record of its files (replacement.h) and renames
// it to `path`, replacing a folder that is there; without Commit() it is removed. Throws
// InputError, naming the path, if it cannot be created or a folder that is there is not
// replaceable.
class AtomicFolder {
 public:
  explicit AtomicFolder(const std::filesystem::path& path);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  const std::filesystem::path& TemporaryPath() const { return temporary_path_; }
  void Commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_path_;
  bool committed_ = false;
};

// Calls `write` with a stream (classic locale, 17 digits, binary mode), then checks that every byte
// reached the disk and renames. Throws InputError, naming the path, if it cannot be written.
void WriteFileAtomically(const std::filesystem::path& path,
                         const std::function<void(std::ostream&)>& write);

// The same for an HTML page, with a seal (replacement.h).
void WriteSealedPage(const std::filesystem::path& path,
                     const std::function<void(std::ostream&)>& write);

// The same without waiting for the disk: for many files in a row, which SyncFileSystem() secures in
// one go.
void WriteFileAtomicallyUnsynced(const std::filesystem::path& path,
                                 const std::function<void(std::ostream&)>& write);

// The same without the rename, for files inside an AtomicFolder.
void WriteFile(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

// Copies a file, replacing the content of `to`. The copy takes no space where the file system can
// share blocks. Throws InputError that names the file which cannot be read or written.
void CopyFile(const std::filesystem::path& from, const std::filesystem::path& to);

// Copies a file atomically, replacing `to`; later edits of one file do not change the other.
// Creates the missing parents of `to`. Throws InputError as CopyFile() does.
void CloneFile(const std::filesystem::path& from, const std::filesystem::path& to);

// Renames a file, replacing `to`, or copies it if they are in different file systems. Creates the
// missing parents of `to`.
void MoveFile(const std::filesystem::path& from, const std::filesystem::path& to);

// Waits until everything that was written to the file system of `folder` has reached the disk.
// Throws InputError, naming the folder, if some of it cannot be written.
void SyncFileSystem(const std::filesystem::path& folder);

}  // namespace velamap
