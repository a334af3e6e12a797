#include "importer/base/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <climits>
#include <sstream>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/log.h"

namespace velamap {
namespace {

constexpr std::size_t kMaxRecordSize = 200;

std::string HostName() {
  std::array<char, HOST_NAME_MAX + 1> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::string ReadHolder(int file) {
  std::array<char, kMaxRecordSize> text{};
  const ssize_t size = pread(file, text.data(), text.size(), 0);
  return std::string(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
}

// Waits up to a second for a holder that has the lock but has not written its record yet.
std::string WaitForHolder(int file) {
  constexpr int kMaxNumTries = 200;  // the scheduler may have paused it just then
  for (int i = 0;; ++i) {
    const std::string text = DescribeLockHolder(ReadHolder(file), std::time(nullptr), HostName());
    if (!text.empty() || i == kMaxNumTries) return text;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

void WriteHolder(int file) {
  const std::string record =
      fmt::format("{} {} {}\n", std::time(nullptr), getpid(), HostName()).substr(0, kMaxRecordSize);
  // First removes the record of a holder that was killed, so that no other run reports it.
  const bool written = ftruncate(file, 0) == 0 && pwrite(file, record.data(), record.size(), 0) ==
                                                      static_cast<ssize_t>(record.size());
  if (!written) LogDebug("the lock's file cannot be written");  // the lock holds all the same
}

// Whether the file is empty, as after a crash, or holds the record of a holder. Any other one of
// this name is the user's.
bool IsLockOfOurs(int file) {
  struct stat status {};
  if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) return false;
  if (status.st_size == 0) return true;
  std::istringstream words(ReadHolder(file));
  std::time_t since = 0;
  long process_id = 0;
  std::string host, more;
  constexpr std::time_t kBeforeAnyLock = 1'000'000'000;
  return status.st_size <= static_cast<off_t>(kMaxRecordSize) && (words >> since >> process_id) &&
         since > kBeforeAnyLock && process_id > 0 && (words >> host, !(words >> more));
}

// Whether `path` still leads to the open file: its last holder may have removed it.
bool IsStillThere(const std::filesystem::path& path, int file) {
  struct stat of_path {
  }, of_file{};
  return stat(path.c_str(), &of_path) == 0 && fstat(file, &of_file) == 0 &&
         of_path.st_dev == of_file.st_dev && of_path.st_ino == of_file.st_ino;
}

}  // namespace

std::string DescribeLockHolder(const std::string& record, std::time_t now,
                               const std::string& host) {
  std::istringstream words(record);
  std::time_t since = 0;
  long process_id = 0;
  std::string holder_host;
  if (!(words >> since >> process_id)) return "";
  words >> holder_host;
  constexpr std::time_t kDay = 24 * 60 * 60;
  if (since < 0 || since > now + kDay) return "";  // a damaged record
  const std::tm start = fmt::localtime(since), today = fmt::localtime(now);
  const bool is_today = start.tm_year == today.tm_year && start.tm_yday == today.tm_yday;
  return fmt::format("since {}{:%H:%M}, process {}{}",
                     is_today ? "" : fmt::format("{:%Y-%m-%d} ", start), start, process_id,
                     holder_host.empty() || holder_host == host ? "" : " on " + holder_host);
}

FileLock::FileLock(const std::filesystem::path& path, const std::string& what) : path_(path) {
  while (file_ < 0) {
    // Closed on exec, so that a COLMAP process that outlives us does not hold it.
    int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    // The file of another user can be locked without being written.
    if (file < 0 && errno == EACCES) file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) return;
    if (flock(file, LOCK_EX | LOCK_NB) != 0) {
      const bool is_held = errno == EWOULDBLOCK;
      const std::string holder = is_held ? WaitForHolder(file) : "";
      close(file);
      if (!is_held) {
        LogWarning("{}: the file system has no locks; start one run at a time", path.string());
        return;
      }
      throw InputError(
          fmt::format("{}: another velamap process is using it{}; wait until it has finished, or "
                      "choose another folder",
                      what, holder.empty() ? "" : " (" + holder + ")"));
    }
    if (!IsLockOfOurs(file)) {
      close(file);
      throw InputError(
          fmt::format("{}: velamap did not write this file, which has the name of its lock; move "
                      "it away",
                      path.string()));
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
