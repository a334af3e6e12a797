#include "importer/base/files.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

std::string Shown(const fs::path& path) { return path.empty() ? "''" : path.string(); }

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

}  // namespace

bool Exists(const fs::path& path) { return TypeOf(path) != fs::file_type::not_found; }

bool IsFolder(const fs::path& path) { return TypeOf(path) == fs::file_type::directory; }

bool IsRegularFile(const fs::path& path) { return TypeOf(path) == fs::file_type::regular; }

std::uintmax_t FileSize(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  CheckRead(error, path);
  return size;
}

fs::path AbsolutePath(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  CheckRead(error, path);
  return absolute.lexically_normal();
}

fs::path CanonicalPath(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  CheckRead(error, path);
  const fs::path canonical = fs::weakly_canonical(absolute, error);
  CheckRead(error, path);
  return canonical;
}

fs::path AbsoluteFolder(const fs::path& path) {
  const fs::path absolute = AbsolutePath(path);
  return absolute.has_filename() ? absolute : absolute.parent_path();
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
  std::error_code error;
  fs::recursive_directory_iterator it(folder, fs::directory_options::follow_directory_symlink,
                                      error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    std::error_code ignored;  // a link that leads nowhere is no file
    if (it->path().filename().string().front() == '.') {
      it.disable_recursion_pending();
    } else if (it->is_regular_file(ignored)) {
      files.push_back(it->path());
    }
  }
  CheckRead(error, folder);
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
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  std::string pattern = (parent / "velamap_XXXXXX").string();
  if (!error && mkdtemp(pattern.data()) == nullptr) {
    error = std::error_code(errno, std::generic_category());
  }
  if (error) {
    throw InputError(
        fmt::format("{}: no folder for temporary files: {}; set TMPDIR", pattern, error.message()));
  }
  path_ = pattern;
}

void LinkOrCopyFile(const fs::path& from, const fs::path& to) {
  const fs::path target = CanonicalPath(from);
  CreateFolders(to.parent_path());
  std::error_code error;
  fs::create_hard_link(target, to, error);
  if (!error) return;
  const fs::path temporary_path = to.parent_path() / ("." + to.filename().string() + ".tmp");
  fs::copy_file(target, temporary_path, fs::copy_options::overwrite_existing, error);
  if (!error) fs::rename(temporary_path, to, error);
  if (error) RemoveAll(temporary_path);
  CheckWritten(error, to);
}

void CopyFile(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  CheckWritten(error, to);
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
