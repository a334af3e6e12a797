// One run at a time: a lock that other runs of velamap see, on this machine or another one that
// shares the file system. It ends with the process, however that ends.

#pragma once

#include <ctime>
#include <filesystem>
#include <string>

namespace velamap {

// "since 14:02, process 4711" in local time; with the date where it is not that of `now`, and with
// the holder's host where it is not `host`. `record` is the text of a lock's file: seconds since
// 1970, process, host. Empty if it is no such text.
std::string DescribeLockHolder(const std::string& record, std::time_t now, const std::string& host);

class FileLock {
 public:
  // Takes the lock whose file is `path`, and writes since when and by which process it is held.
  // Throws InputError, which begins with `what` and names the holder, if another process or
  // FileLock holds it, or if a file of this name is not one of ours. If the lock file cannot be
  // opened, the run continues without a lock, because writing will normally fail as well and report
  // the reason. If the file system has no locks, a warning says so.
  FileLock(const std::filesystem::path& path, const std::string& what);
  ~FileLock();  // removes the file
  bool IsHeld() const { return file_ >= 0; }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace velamap
