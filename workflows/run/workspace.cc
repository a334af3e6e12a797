#include "workflows/run/workspace.h"

#include <unistd.h>

#include <set>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/database/colmap_database.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

bool IsInside(const fs::path& path, const fs::path& folder) {
  const fs::path relative = CanonicalPath(path).lexically_relative(CanonicalPath(folder));
  return !relative.empty() && *relative.begin() != "..";
}

bool IsOurDatabase(const fs::path& path) {
  return IsRegularFile(path) &&
         ColmapDatabase(path.string(), ColmapDatabase::Mode::kReadOnly).ReadDetector().has_value();
}

// The name of an entry that shows that the folder is not a workspace; "" if there is none.
std::string ForeignEntry(const WorkspacePaths& paths, const std::string& image_path) {
  if (Exists(paths.Log()) || IsOurDatabase(paths.Database())) return "";
  for (const fs::path& entry : FolderEntries(paths.root)) {
    if (!IsInside(image_path, entry)) return entry.filename().string();
  }
  return "";
}

void CheckExisting(const WorkspacePaths& paths, const std::string& image_path) {
  if (!IsFolder(paths.root)) {
    throw InputError(fmt::format("--workspace_path {}: is a file; give a folder, new or empty",
                                 paths.root.string()));
  }
  const std::string foreign = ForeignEntry(paths, image_path);
  if (!foreign.empty()) {
    throw InputError(
        fmt::format("--workspace_path {}: holds {} and is not a workspace of velamap; "
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

// Removes temporary folders of an interrupted run (importer/base/atomic_output.h).
void RemoveLeftovers(const WorkspacePaths& paths) {
  for (const fs::path& entry : FolderEntries(paths.root)) {
    const std::string name = entry.filename().string();
    if (name.rfind(".sparse.tmp-", 0) == 0 || name.rfind(".shape.tmp-", 0) == 0) RemoveAll(entry);
  }
}

std::set<std::string> ImageNames(const Model& model) {
  std::set<std::string> names;
  for (const ModelImage& image : model.images) names.insert(image.name);
  return names;
}

}  // namespace

Workspace::Workspace(const std::string& path, const std::string& image_path) {
  paths_.root = AbsoluteFolder(path);
  if (IsFolder(image_path) && IsInside(paths_.root, image_path)) {
    throw InputError(
        fmt::format("--workspace_path {}: lies in the image folder {}, where its "
                    "images would be read as photographs; give another folder",
                    paths_.root.string(), image_path));
  }
  if (Exists(paths_.root)) {
    CheckExisting(paths_, image_path);
    RemoveLeftovers(paths_);
    return;
  }
  fs::path first_made = paths_.root;
  while (!Exists(first_made.parent_path())) first_made = first_made.parent_path();
  CreateFolders(paths_.root);
  first_made_ = first_made;
}

Workspace::~Workspace() {
  if (!first_made_) return;
  RemoveAll(paths_.root);
  // Parents go only if they are empty.
  for (fs::path made = paths_.root; made != *first_made_;) {
    made = made.parent_path();
    RemoveFileOrEmptyFolder(made);
  }
}

void AddModelImages(const Model& model, const std::string& image_path,
                    const fs::path& images_path) {
  const bool is_video = !IsFolder(image_path);
  std::vector<std::string> missing;
  for (const std::string& name : ImageNames(model)) {
    if (Exists(images_path / name)) continue;
    if (!is_video && Exists(fs::path(image_path) / name)) {
      LinkOrCopyFile(fs::path(image_path) / name, images_path / name);
    } else {
      missing.push_back(name);
    }
  }
  if (missing.empty()) return;
  spdlog::warn(
      "{}: {} images of the model are missing, such as {}; delete the workspace to read them again",
      images_path.string(), missing.size(), missing.front());
}

void RemoveOtherImages(const Model& model, const std::vector<std::string>& database_names,
                       const std::string& image_path, const fs::path& images_path) {
  const bool is_video = !IsFolder(image_path);
  if (IsInside(image_path, images_path)) return;  // these are the originals
  const std::set<std::string> model_names = ImageNames(model);
  for (const std::string& name : database_names) {
    if (model_names.count(name) > 0) continue;
    if (is_video || Exists(fs::path(image_path) / name)) {
      RemoveFileOrEmptyFolder(images_path / name);
    }
  }
}

}  // namespace velamap
