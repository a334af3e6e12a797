#include "importer/base/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

// "since 14:02, process 4711", as the holder of the lock has written it.
std::string HolderText(int file) {
  std::array<char, 100> text{};
  const ssize_t size = pread(file, text.data(), text.size() - 1, 0);
  return size > 0 ? " " + std::string(text.data(), static_cast<std::size_t>(size)) : "";
}

void WriteHolder(int file) {
  const std::time_t now = std::time(nullptr);
  const std::string text = fmt::format("since {:%H:%M}, process {}", fmt::localtime(now), getpid());
  const bool written = ftruncate(file, 0) == 0 && pwrite(file, text.data(), text.size(), 0) ==
                                                      static_cast<ssize_t>(text.size());
  if (!written) spdlog::debug("the lock's file cannot be written");  // the lock holds all the same
}

// Whether `path` still leads to the open file: its last holder may have removed it.
bool IsStillThere(const std::filesystem::path& path, int file) {
  struct stat of_path {
  }, of_file{};
  return stat(path.c_str(), &of_path) == 0 && fstat(file, &of_file) == 0 &&
         of_path.st_dev == of_file.st_dev && of_path.st_ino == of_file.st_ino;
}

}  // namespace

FileLock::FileLock(const std::filesystem::path& path, const std::string& what) : path_(path) {
  while (file_ < 0) {
    // Closed on exec, so that a COLMAP that outlives us does not hold it.
    int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    // The file of another user can be locked without being written.
    if (file < 0 && errno == EACCES) file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) return;
    if (flock(file, LOCK_EX | LOCK_NB) != 0) {
      const bool is_held = errno == EWOULDBLOCK;
      const std::string holder = is_held ? HolderText(file) : "";
      close(file);
      if (!is_held) {
        spdlog::warn("{}: the file system has no locks; start one run at a time", path.string());
        return;
      }
      throw InputError(fmt::format(
          "{}: another velamap works here{}; wait until it has finished, or choose another folder",
          what, holder));
    }
    if (IsStillThere(path, file)) {
      file_ = file;
    } else {
      close(file);
    }
  }
  WriteHolder(file_);
}

FileLock::~FileLock() {
  if (file_ < 0) return;
  // Removed while it is held, so that whoever opens the path later makes a new one. Another run may
  // have made its own after the whole folder was removed.
  if (IsStillThere(path_, file_)) unlink(path_.c_str());
  close(file_);
}

}  // namespace velamap
