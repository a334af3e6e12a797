#include "workflows/run/workspace.h"

#include <unistd.h>

#include <set>
#include <system_error>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "importer/base/error.h"
#include "importer/database/colmap_database.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

fs::path AbsoluteFolder(const std::string& path) {
  const fs::path absolute = fs::absolute(path).lexically_normal();
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

bool IsInside(const fs::path& path, const fs::path& folder) {
  const fs::path relative =
      fs::weakly_canonical(path).lexically_relative(fs::weakly_canonical(folder));
  return !relative.empty() && *relative.begin() != "..";
}

bool IsOurDatabase(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) &&
         ColmapDatabase(path.string(), ColmapDatabase::Mode::kReadOnly).ReadDetector().has_value();
}

// The name of something that keeps a folder from being taken as the workspace; "" if nothing does.
std::string ForeignEntry(const WorkspacePaths& paths, const std::string& image_path) {
  if (fs::exists(paths.Log()) || IsOurDatabase(paths.Database())) return "";
  for (const auto& entry : fs::directory_iterator(paths.root)) {
    if (!IsInside(image_path, entry.path())) return entry.path().filename().string();
  }
  return "";
}

void CheckExisting(const WorkspacePaths& paths, const std::string& image_path) {
  if (!fs::is_directory(paths.root)) {
    throw InputError(fmt::format("--workspace_path {}: is a file; give a folder, new or empty",
                                 paths.root.string()));
  }
  const std::string foreign = ForeignEntry(paths, image_path);
  if (!foreign.empty()) {
    throw InputError(
        fmt::format("--workspace_path {}: holds {} and is no workspace of velamap; "
                    "give a new or an empty folder",
                    paths.root.string(), foreign));
  }
  if (access(paths.root.c_str(), W_OK | X_OK) != 0) {
    throw InputError(
        fmt::format("--workspace_path {}: cannot be written; choose another folder or "
                    "change its permissions",
                    paths.root.string()));
  }
}

// What an interrupted run has left of its temporary folders (importer/base/atomic_output.h).
void RemoveLeftovers(const WorkspacePaths& paths) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(paths.root)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(".sparse.tmp-", 0) == 0 || name.rfind(".shape.tmp-", 0) == 0) {
      fs::remove_all(entry.path(), ignored);
    }
  }
}

std::set<std::string> ImageNames(const Model& model) {
  std::set<std::string> names;
  for (const ModelImage& image : model.images) names.insert(image.name);
  return names;
}

// A hard link costs no space; a copy is renamed when whole.
void LinkOrCopy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (!error) fs::create_hard_link(fs::canonical(from), to, error);
  if (!error) return;
  const fs::path temporary_path = to.parent_path() / ("." + to.filename().string() + ".tmp");
  fs::copy_file(from, temporary_path, fs::copy_options::overwrite_existing, error);
  if (!error) fs::rename(temporary_path, to, error);
  if (error) {
    std::error_code ignored;
    fs::remove(temporary_path, ignored);
    throw InputError(fmt::format("{}: cannot be written: {}", to.string(), error.message()));
  }
}

}  // namespace

Workspace::Workspace(const std::string& path, const std::string& image_path) {
  paths_.root = AbsoluteFolder(path);
  try {
    if (fs::is_directory(image_path) && IsInside(paths_.root, image_path)) {
      throw InputError(
          fmt::format("--workspace_path {}: lies in the image folder {}, where its "
                      "images would be read as photographs; give another folder",
                      paths_.root.string(), image_path));
    }
    if (fs::exists(paths_.root)) {
      CheckExisting(paths_, image_path);
      RemoveLeftovers(paths_);
      return;
    }
    fs::path first_made = paths_.root;
    while (!fs::exists(first_made.parent_path())) first_made = first_made.parent_path();
    fs::create_directories(paths_.root);
    first_made_ = first_made;
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("--workspace_path {}: cannot be made or read: {}",
                                 paths_.root.string(), error.code().message()));
  }
}

Workspace::~Workspace() {
  std::error_code ignored;
  if (!first_made_) return;
  fs::remove_all(paths_.root, ignored);
  // Parents go only if they are empty.
  for (fs::path made = paths_.root; made != *first_made_;) {
    made = made.parent_path();
    fs::remove(made, ignored);
  }
}

void AddModelImages(const Model& model, const std::string& image_path,
                    const fs::path& images_path) {
  const bool is_video = !fs::is_directory(image_path);
  std::vector<std::string> missing;
  for (const std::string& name : ImageNames(model)) {
    std::error_code error;
    if (fs::exists(images_path / name, error)) continue;
    if (!is_video && fs::exists(fs::path(image_path) / name, error)) {
      LinkOrCopy(fs::path(image_path) / name, images_path / name);
    } else {
      missing.push_back(name);
    }
  }
  if (missing.empty()) return;
  spdlog::warn(
      "{}: {} images of the model are not there, such as {}; delete the workspace to "
      "read them again",
      images_path.string(), missing.size(), missing.front());
}

void RemoveOtherImages(const Model& model, const std::vector<std::string>& database_names,
                       const std::string& image_path, const fs::path& images_path) {
  const bool is_video = !fs::is_directory(image_path);
  if (IsInside(image_path, images_path)) return;  // these are the originals
  const std::set<std::string> model_names = ImageNames(model);
  for (const std::string& name : database_names) {
    std::error_code ignored;
    if (model_names.count(name) > 0) continue;
    if (is_video || fs::exists(fs::path(image_path) / name, ignored)) {
      fs::remove(images_path / name, ignored);
    }
  }
}

}  // namespace velamap
