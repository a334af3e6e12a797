// Output that exists as a whole or not at all: it is written to a temporary sibling and renamed
// when it is complete.

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

// The same without waiting for the disk: for many files in a row, which SyncFileSystem() secures in
// one go.
void WriteFileAtomicallyUnsynced(const std::filesystem::path& path,
                                 const std::function<void(std::ostream&)>& write);

// The same without the rename, for files inside an AtomicFolder.
void WriteFile(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

// Waits until everything that was written to the file system of `folder` has reached the disk.
// Throws InputError, naming the folder, if some of it cannot be written.
void SyncFileSystem(const std::filesystem::path& folder);

}  // namespace velamap
