// Output that is whole or not there: written to a temporary sibling, renamed when complete.

#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
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

// Calls `write` with a stream (classic locale, 17 digits, binary mode), then checks that every byte
// reached the disk and renames. Throws InputError, naming the path, if it cannot be written.
void WriteFileAtomically(const std::filesystem::path& path,
                         const std::function<void(std::ostream&)>& write);

// The same without the rename, for files inside an AtomicFolder.
void WriteFile(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

}  // namespace velamap
