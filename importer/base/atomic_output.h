// Output that is whole or not there: written to a temporary sibling, renamed when complete.

#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <set>
#include <string>

namespace velamap {

// A fresh folder beside `path` that Commit() renames to `path`, replacing what is there; without
// Commit() it is removed again and what was there stays. Throws InputError, naming the path, when
// it cannot be made.
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

// A folder is replaced as a whole, so it must hold nothing but what an earlier run wrote: a
// mistyped path shall not cost anyone their files. Throws InputError, naming the path and what is
// in the way, unless `path` is not there, or is a folder with no other files than `known_files`.
void CheckReplaceableFolder(const std::filesystem::path& path,
                            const std::set<std::string>& known_files);

// Calls `write` with a stream (classic locale, 17 digits, binary mode), then checks that every byte
// reached the disk and renames. Throws InputError, naming the path, if it cannot be written.
void WriteFileAtomically(const std::filesystem::path& path,
                         const std::function<void(std::ostream&)>& write);

// The same without the rename, for files inside an AtomicFolder.
void WriteFile(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

}  // namespace velamap
