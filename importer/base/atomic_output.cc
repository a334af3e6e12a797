#include "importer/base/atomic_output.h"

#include <fcntl.h>
#include <linux/fs.h>
#include <stdio.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <locale>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/replacement.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void ThrowCannotWrite(const fs::path& path, const std::string& why) {
  throw InputError(fmt::format("{}: cannot be written: {}", FinalPath(path).string(), why));
}

[[noreturn]] void ThrowCannotRead(const fs::path& path, int error) {
  throw InputError(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(error)));
}

// A file that is closed at the end.
class OpenFile {
 public:
  OpenFile(const fs::path& path, int flags)
      : number_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~OpenFile() { Close(); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int number() const { return number_; }

  // Some file systems notice a full disk only here.
  bool Close() {
    const int number = std::exchange(number_, -1);
    return number < 0 || close(number) == 0;
  }

 private:
  int number_;
};

// Calls fsync() or syncfs(), which may be the first to notice a full disk.
void Sync(const fs::path& path, int (*sync)(int)) {
  const OpenFile file(path, O_RDONLY);
  if (file.number() < 0 || sync(file.number()) != 0) ThrowCannotWrite(path, std::strerror(errno));
}

void WriteStream(const fs::path& path, const fs::path& shown_path,
                 const std::function<void(std::ostream&)>& write) {
  errno = 0;
  std::ofstream stream(path, std::ios::binary | std::ios::trunc);
  if (!stream) ThrowCannotWrite(shown_path, std::strerror(errno));
  stream.imbue(std::locale::classic());
  stream.precision(17);
  write(stream);
  stream.close();
  if (!stream) {
    ThrowCannotWrite(shown_path, errno != 0 ? std::strerror(errno) : "the stream failed");
  }
}

// Calls `write` with the path of a temporary sibling of `target`, and then renames the sibling to
// `target`. Creates missing parents. Messages name `shown_path`.
void ReplaceFile(const fs::path& target, const fs::path& shown_path,
                 const std::function<void(const fs::path&)>& write) {
  CreateFolders(target.parent_path());
  const fs::path temporary_path = TemporarySibling(target);
  try {
    write(temporary_path);
    std::error_code error;
    fs::rename(temporary_path, target, error);
    if (error) ThrowCannotWrite(shown_path, error.message());
  } catch (...) {
    RemoveAll(temporary_path);
    throw;
  }
}

void WriteAndRename(const fs::path& path, bool is_synced,
                    const std::function<void(std::ostream&)>& write) {
  const fs::path target = CanonicalPath(path);
  if (Exists(target) && !IsRegularFile(target)) {
    ThrowCannotWrite(path, "it exists and is not a regular file; choose another output path");
  }
  CheckNotProtected(path);
  ReplaceFile(target, path, [&](const fs::path& temporary_path) {
    WriteStream(temporary_path, path, write);
    if (is_synced) Sync(temporary_path, fsync);
  });
}

// Messages name `from` if it cannot be read, otherwise `shown_to`.
void CopyFile(const fs::path& from, const fs::path& to, const fs::path& shown_to) {
  OpenFile source(from, O_RDONLY | O_NONBLOCK);  // does not wait for the writer of a pipe
  struct stat status {};
  if (source.number() < 0 || fstat(source.number(), &status) != 0) ThrowCannotRead(from, errno);
  if (!S_ISREG(status.st_mode)) ThrowCannotRead(from, ENOTSUP);
  OpenFile copy(to, O_WRONLY | O_CREAT | O_TRUNC);
  if (copy.number() < 0) ThrowCannotWrite(shown_to, std::strerror(errno));
  if (ioctl(copy.number(), FICLONE, source.number()) != 0) {
    // std::filesystem::copy_file calls a full disk an input/output error.
    std::vector<char> buffer(1 << 20);
    ssize_t size = 0;
    while ((size = read(source.number(), buffer.data(), buffer.size())) != 0) {
      if (size < 0 && errno == EINTR) continue;
      if (size < 0) ThrowCannotRead(from, errno);
      if (!WriteAll(copy.number(), buffer.data(), static_cast<std::size_t>(size))) {
        ThrowCannotWrite(shown_to, std::strerror(errno));
      }
    }
  }
  fchmod(copy.number(), status.st_mode & 0777);  // some file systems have no permissions
  if (!copy.Close()) ThrowCannotWrite(shown_to, std::strerror(errno));
}

void WriteRecords(const fs::path& folder) {
  for (const fs::path& entry : FolderEntries(folder)) {
    if (IsFolder(entry)) WriteRecords(entry);
  }
  const std::string record = MakeFolderRecord(folder);
  if (record.empty()) return;
  WriteFile(folder / kFolderRecord, [&](std::ostream& out) { out << record; });
}

}  // namespace

AtomicFolder::AtomicFolder(const fs::path& path) : path_(CanonicalPath(path)) {
  CheckReplaceableFolder(path_);
  CreateFolders(path_.parent_path());
  std::error_code error;
  do {  // a killed run with the same process id may have left a folder
    temporary_path_ = TemporarySibling(path_);
  } while (!fs::create_directory(temporary_path_, error) && !error);
  if (error) ThrowCannotWrite(path_, error.message());
}

AtomicFolder::~AtomicFolder() {
  if (!committed_) RemoveAll(temporary_path_);
}

void AtomicFolder::Commit() {
  VELAMAP_CHECK(!committed_);
  CheckReplaceableFolder(path_);  // somebody may have put a file there meanwhile
  WriteRecords(temporary_path_);
  std::error_code error;
  if (!Exists(path_)) {
    fs::rename(temporary_path_, path_, error);
    if (error) ThrowCannotWrite(path_, error.message());
    committed_ = true;
    return;
  }
  // Exchanges the old folder and the new one in one step if the file system can do it. Otherwise
  // there is no folder for a moment between two renames.
  if (renameat2(AT_FDCWD, temporary_path_.c_str(), AT_FDCWD, path_.c_str(), RENAME_EXCHANGE) == 0) {
    committed_ = true;
    RemoveAll(temporary_path_);
    return;
  }
  const fs::path old_path = TemporarySibling(path_);
  fs::rename(path_, old_path, error);
  if (error) ThrowCannotWrite(path_, error.message());
  fs::rename(temporary_path_, path_, error);
  if (error) {
    std::error_code ignored;
    fs::rename(old_path, path_, ignored);
    ThrowCannotWrite(path_, error.message());
  }
  committed_ = true;
  RemoveAll(old_path);
}

void WriteFileAtomically(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  WriteAndRename(path, true, write);
}

void WriteSealedPage(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  WriteFileAtomically(path, [&](std::ostream& out) {
    std::ostringstream page;
    page.imbue(std::locale::classic());
    page.precision(out.precision());
    write(page);
    out << WithSeal(page.str(), "<!-- ", " -->");
  });
}

void WriteFileAtomicallyUnsynced(const fs::path& path,
                                 const std::function<void(std::ostream&)>& write) {
  WriteAndRename(path, false, write);
}

void WriteFile(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  WriteStream(path, path, write);
  Sync(path, fsync);
}

void CopyFile(const fs::path& from, const fs::path& to) { CopyFile(from, to, to); }

void CloneFile(const fs::path& from, const fs::path& to) {
  ReplaceFile(CanonicalPath(to), to,
              [&](const fs::path& temporary_path) { CopyFile(from, temporary_path, to); });
}

void MoveFile(const fs::path& from, const fs::path& to) {
  const fs::path target = CanonicalPath(to);
  CreateFolders(target.parent_path());
  std::error_code error;
  fs::rename(from, target, error);
  if (error == std::errc::cross_device_link) {
    CloneFile(from, target);
    RemoveAll(from);
    return;
  }
  if (error) ThrowCannotWrite(to, error.message());
}

void SyncFileSystem(const fs::path& folder) { Sync(folder, syncfs); }

}  // namespace velamap
