// A lock that lets only one run of velamap work at a time, among the runs on this machine and on
// others that share the file system. It is released when the process ends, however that happens.

#pragma once

#include <ctime>
#include <filesystem>
#include <string>

namespace velamap {

// "since 14:02, process 4711" in local time, with the date unless that is the date of `now`, and
// with the holder's host unless that is `host`. `record` is the text of a lock file: seconds since
// 1970, process, host. Returns an empty text for any other `record`.
std::string DescribeLockHolder(const std::string& record, std::time_t now, const std::string& host);

class FileLock {
 public:
  // Acquires the lock file `path` and records the time, process and host of the holder in it.
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
