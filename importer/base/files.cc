#include "importer/base/files.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/file_lock.h"
#include "importer/base/replacement.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

std::string Shown(const fs::path& path) { return path.empty() ? "''" : FinalPath(path).string(); }

void CheckRead(const std::error_code& error, const fs::path& path) {
  if (!error) return;
  throw InputError(fmt::format("{}: cannot be read: {}", Shown(path), error.message()));
}

void CheckWritten(const std::error_code& error, const fs::path& path) {
  if (!error) return;
  throw InputError(fmt::format("{}: cannot be written: {}", Shown(path), error.message()));
}

fs::file_type TypeOf(const fs::path& path) {
  std::error_code error;
  const fs::file_type type = fs::status(path, error).type();
  if (type != fs::file_type::not_found) CheckRead(error, path);
  return type;
}

fs::path FromRoot(const fs::path& path) {
  if (path.empty()) CheckRead(std::make_error_code(std::errc::no_such_file_or_directory), path);
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  if (!error) return absolute;
  throw InputError(
      fmt::format("{}: the current folder cannot be read ({}); change to a folder that is there",
                  Shown(path), error.message()));
}

// A name that no user gives to a folder.
constexpr std::string_view kScratchName = ".velamap_scratch_XXXXXX";
constexpr std::string_view kScratchPrefix = kScratchName.substr(0, kScratchName.find("XXXXXX"));
constexpr char kScratchLock[] = "lock";

// Removes a folder for temporary files if nobody holds its lock, because its run was killed. The
// lock file is missing if the run was killed before it created the lock or while it removed the
// folder.
void RemoveIfAbandoned(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(fs::symlink_status(folder, error))) return;
  try {
    const FileLock lock(folder / kScratchLock, folder.string());
    if (lock.IsHeld()) RemoveAll(folder);
  } catch (const InputError&) {
    // In use.
  }
}

void RemoveAbandoned(const fs::path& parent) {
  std::error_code error;
  for (fs::directory_iterator it(parent, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool is_ours = name.size() == kScratchName.size() && name.rfind(kScratchPrefix, 0) == 0;
    if (is_ours) RemoveIfAbandoned(it->path());
  }
}

}  // namespace

bool Exists(const fs::path& path) { return TypeOf(path) != fs::file_type::not_found; }

bool IsFolder(const fs::path& path) { return TypeOf(path) == fs::file_type::directory; }

bool IsRegularFile(const fs::path& path) { return TypeOf(path) == fs::file_type::regular; }

bool IsLink(const fs::path& path) noexcept {
  std::error_code error;
  return fs::is_symlink(path, error);
}

bool IsPipe(const fs::path& path) { return TypeOf(path) == fs::file_type::fifo; }

std::uintmax_t FileSize(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  CheckRead(error, path);
  return size;
}

fs::path AbsolutePath(const fs::path& path) {
  // After a link, ".." means the parent of the folder that the link leads to.
  fs::path result;
  for (const fs::path& part : FromRoot(path)) {
    if (part == "..") {
      result = CanonicalPath(result).parent_path();
    } else if (part != ".") {
      result /= part;
    }
  }
  return result;
}

fs::path CanonicalPath(const fs::path& path) {
  constexpr int kMaxNumLinks = 40;  // as in Linux
  const fs::path absolute = FromRoot(path);
  std::deque<fs::path> parts(absolute.begin(), absolute.end());
  fs::path result;
  for (int num_links = 0; !parts.empty();) {
    const fs::path part = parts.front();
    parts.pop_front();
    if (part.empty() || part == ".") continue;
    if (part == "..") {
      result = result.parent_path();
      continue;
    }
    std::error_code error;
    const fs::path next = result / part;
    const fs::file_type type = fs::symlink_status(next, error).type();
    if (type != fs::file_type::not_found) CheckRead(error, path);
    if (type != fs::file_type::symlink) {
      result = next;
      continue;
    }
    const fs::path target = fs::read_symlink(next, error);
    if (++num_links > kMaxNumLinks) {
      error = std::make_error_code(std::errc::too_many_symbolic_link_levels);
    }
    CheckRead(error, path);
    parts.insert(parts.begin(), target.begin(), target.end());  // an absolute one begins anew: "/"
  }
  return result;
}

fs::path AbsoluteFolder(const fs::path& path) {
  const fs::path absolute = AbsolutePath(path);
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

std::string LowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::vector<fs::path> FolderEntries(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    entries.push_back(it->path());
  }
  CheckRead(error, folder);
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<fs::path> FilesBelow(const fs::path& folder) {
  std::vector<fs::path> files;
  std::deque<fs::path> folders = {folder}, linked_folders;
  std::set<fs::path> entered;  // canonical: links may lead in circles
  while (!folders.empty() || !linked_folders.empty()) {
    std::deque<fs::path>& next = folders.empty() ? linked_folders : folders;
    const fs::path current = next.front();
    next.pop_front();
    if (!entered.insert(CanonicalPath(current)).second) continue;
    for (const fs::path& entry : FolderEntries(current)) {
      if (entry.filename().string().front() == '.') continue;
      std::error_code ignored;  // set by a dangling link
      if (fs::is_directory(entry, ignored)) {
        (IsLink(entry) ? linked_folders : folders).push_back(entry);
      } else {
        files.push_back(entry);
      }
    }
  }
  return files;
}

void CreateFolders(const fs::path& path) {
  if (path.empty()) return;
  std::error_code error;
  fs::create_directories(path, error);
  if (!error && !IsFolder(path)) error = std::make_error_code(std::errc::not_a_directory);
  CheckWritten(error, path);
}

TemporaryFolder::TemporaryFolder() {
  const char* wanted = std::getenv("TMPDIR");
  const fs::path parent = wanted != nullptr && *wanted != '\0' ? wanted : "/tmp";
  std::error_code error;
  if (!fs::is_directory(parent, error) && !error) {
    error = std::make_error_code(std::errc::not_a_directory);
  }
  if (!error) RemoveAbandoned(parent);
  // Before the folder is locked, another run may take it for abandoned and remove it.
  constexpr int kMaxNumTries = 100;
  for (int i = 0; !error && i < kMaxNumTries; ++i) {
    std::string pattern = (parent / kScratchName).string();
    if (mkdtemp(pattern.data()) == nullptr) {
      error = std::error_code(errno, std::generic_category());
      break;
    }
    path_ = pattern;
    try {
      lock_ = std::make_unique<FileLock>(path_ / kScratchLock, pattern);
      if (Exists(path_)) return;
    } catch (const InputError&) {
    }
  }
  if (!error) error = std::make_error_code(std::errc::resource_unavailable_try_again);
  throw InputError(
      fmt::format("TMPDIR {}: no folder for temporary files can be made there: {}; set TMPDIR to a "
                  "folder that can be written",
                  parent.string(), error.message()));
}

TemporaryFolder::~TemporaryFolder() { RemoveAll(path_); }

bool IsSameFile(const fs::path& path1, const fs::path& path2) {
  std::error_code error;
  return fs::equivalent(path1, path2, error) && !error;
}

std::uint64_t Hash(std::string_view bytes, std::uint64_t hash) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

std::uint64_t HashOfFile(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::vector<char> buffer(1 << 16);
  std::uint64_t hash = Hash("");
  while (stream) {
    stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    hash = Hash({buffer.data(), static_cast<std::size_t>(stream.gcount())}, hash);
  }
  if (!stream.eof()) throw InputError(Shown(path) + ": cannot be read");
  return hash;
}

bool WriteAll(int file, const void* data, std::size_t size) {
  const char* rest = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t written = write(file, rest, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    rest += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

void RemoveAll(const fs::path& path) noexcept {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

void RemoveFileOrEmptyFolder(const fs::path& path) noexcept {
  std::error_code ignored;
  fs::remove(path, ignored);
}

}  // namespace velamap
