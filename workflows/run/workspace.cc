#include "workflows/run/workspace.h"

#include <unistd.h>

#include <algorithm>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/base/replacement.h"
#include "importer/database/colmap_database.h"
#include "importer/video/written_frame.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

constexpr char kLockName[] = ".velamap.lock";

bool IsOurDatabase(const fs::path& path) {
  return IsRegularFile(path) &&
         ColmapDatabase(path.string(), ColmapDatabase::Mode::kReadOnly).ReadDetector().has_value();
}

// The name of an entry that shows that the folder is not a workspace; "" if there is none.
std::string ForeignEntry(const WorkspacePaths& paths, const std::string& image_path) {
  const std::vector<fs::path> entries = FolderEntries(paths.root);
  const auto foreign = std::find_if(entries.begin(), entries.end(), [&](const fs::path& entry) {
    return entry.filename() != kLockName && !IsInside(image_path, entry);
  });
  // Checked last: another run may be creating the workspace right now, and the log is its first
  // file.
  if (foreign == entries.end() || Exists(paths.Log()) || IsOurDatabase(paths.Database())) return "";
  return foreign->filename().string();
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

bool AreEqual(const fs::path& file1, const fs::path& file2) {
  return IsSameFile(file1, file2) ||
         (FileSize(file1) == FileSize(file2) && HashOfFile(file1) == HashOfFile(file2));
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
  std::optional<fs::path> first_made;
  if (Exists(paths_.root)) {
    CheckExisting(paths_, image_path);
  } else {
    first_made = paths_.root;
    while (!Exists(first_made->parent_path())) first_made = first_made->parent_path();
    CreateFolders(paths_.root);
  }
  lock_.emplace(paths_.root / kLockName, "--workspace_path " + paths_.root.string());
  if (!Exists(paths_.root)) {
    throw InputError(
        fmt::format("--workspace_path {}: another velamap has just removed it; run again",
                    paths_.root.string()));
  }
  first_made_ = first_made;
  for (const fs::path& folder : {paths_.root, paths_.Images(), paths_.Sparse()}) {
    RemoveUnfinished(folder);
  }
}

std::vector<UsedPath> WorkspaceOutputs(const std::string& path, const std::string& used_by) {
  const WorkspacePaths paths{AbsoluteFolder(path)};
  std::vector<UsedPath> outputs;
  // The logs and the database are added to, not replaced.
  for (const fs::path& file : {paths.Database(), paths.Log(), paths.ColmapLog()}) {
    outputs.push_back({used_by, file});
  }
  for (const fs::path& file : {paths.RegistrationCsv(), paths.Report(), paths.Timing()}) {
    outputs.push_back({used_by, file, false, true});
  }
  for (const fs::path& folder : {paths.Sparse(), paths.Shape()}) {
    outputs.push_back({used_by, folder, true});
  }
  return outputs;
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
  if (!is_video && IsSameFile(image_path, images_path)) return;  // these are the originals
  std::vector<std::string> missing, different;
  for (const std::string& name : ImageNames(model)) {
    const fs::path original = fs::path(image_path) / name, copy = images_path / name;
    const bool has_original = !is_video && Exists(original);
    if (!Exists(copy)) {
      has_original ? CloneFile(original, copy) : missing.push_back(name);
    } else if (has_original && IsSameFile(original, copy)) {
      if (!IsInside(copy, images_path)) continue;  // a link in images/ leads to the originals
      CloneFile(original, copy);                   // an earlier velamap made hard links
    } else if (has_original && FileSize(original) != FileSize(copy)) {
      different.push_back(name);
    }
  }
  if (!different.empty()) {
    LogWarning("{}: {} images are not the photographs of the same names, such as {}; they stay",
               images_path.string(), different.size(), different.front());
  }
  if (missing.empty()) return;
  LogWarning("{}: {} images of the model are missing, such as {}; --import_anew 1 reads them again",
             images_path.string(), missing.size(), missing.front());
}

void RemoveOtherImages(const Model& model, const std::vector<std::string>& database_names,
                       const std::string& image_path, const fs::path& images_path) {
  const bool is_video = !IsFolder(image_path);
  if (IsInside(image_path, images_path)) return;  // these are the originals
  const std::set<std::string> model_names = ImageNames(model);
  for (const std::string& name : database_names) {
    const fs::path original = fs::path(image_path) / name, copy = images_path / name;
    if (model_names.count(name) > 0 || !IsRegularFile(copy) || !IsInside(copy, images_path))
      continue;
    // A link to the copy is not a second copy.
    const bool can_be_restored = is_video ? IsWrittenFrame(copy)
                                          : IsRegularFile(original) &&
                                                CanonicalPath(original) != CanonicalPath(copy) &&
                                                AreEqual(copy, original);
    if (can_be_restored) RemoveFileOrEmptyFolder(copy);
  }
}

}  // namespace velamap
