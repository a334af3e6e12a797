#include "workflows/options/path_check.h"

#include <filesystem>
#include <sstream>
#include <string>
#include <variant>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/replacement.h"
#include "importer/layout/layout.h"
#include "importer/text/shown_text.h"
#include "importer/video/source_file.h"
#include "reconstruct/model/model_io.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/workspace.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

struct UsedPaths {
  std::vector<UsedPath> inputs, outputs;
};

void AddModelFiles(const std::string& used_by, const fs::path& folder, UsedPaths* paths) {
  for (const std::string& name : ModelFileNames()) {
    if (Exists(folder / name)) paths->inputs.push_back({used_by, folder / name});
  }
}

void AddLayout(const std::string& used_by, const std::string& path, UsedPaths* paths) {
  paths->inputs.push_back({used_by, path});
  try {
    const std::string dictionary = ReadLayout(path).dictionary;
    if (IsRegularFile(dictionary)) paths->inputs.push_back({used_by, dictionary});
  } catch (const InputError&) {
    // The command reports it when it reads the layout.
  }
}

void AddPictures(const std::string& used_by, const fs::path& path, UsedPaths* paths) {
  paths->inputs.push_back({used_by, path});
  if (!IsFolder(path)) return;
  for (const fs::path& file : FilesBelow(path)) {
    if (HasImageExtension(file.string())) paths->inputs.push_back({used_by, file});
  }
}

// The default file of an option that is left out. Next to phone.yml, *.html is phone.html.
fs::path DefaultPath(const Option& option) {
  const fs::path beside = AbsoluteFolder(*option.beside);
  const std::string& name = option.name_beside;
  const bool takes_its_name = name.front() == '*';
  return beside.parent_path() / (takes_its_name ? beside.stem().string() + name.substr(1) : name);
}

// Comparisons also read the uncertainty of the model beside a folder of a shape.
void AddShape(const std::string& used_by, const fs::path& path, UsedPaths* paths) {
  paths->inputs.push_back({used_by, ShapeFile(path)});
  AddModelFiles(used_by, ModelFolderOfShape(path), paths);
}

void AddUse(PathUse use, const std::string& used_by, const std::string& path, bool is_default_name,
            UsedPaths* paths) {
  switch (use) {
    case PathUse::kNone:
      return;
    case PathUse::kReadsFile:
      return paths->inputs.push_back({used_by, path});
    case PathUse::kReadsLayout:
      return AddLayout(used_by, path, paths);
    case PathUse::kReadsPictures:
      return AddPictures(used_by, path, paths);
    case PathUse::kReadsModel:
      paths->inputs.push_back({used_by, path});
      return AddModelFiles(used_by, path, paths);
    case PathUse::kReadsShape:
      return AddShape(used_by, path, paths);
    case PathUse::kWritesFile:
      return paths->outputs.push_back({used_by, path, false, is_default_name});
    case PathUse::kWritesOwnFile:
      return paths->outputs.push_back({used_by, path, false, true});
    case PathUse::kWritesFolder:
      return paths->outputs.push_back({used_by, path, true});
    case PathUse::kAddsToFolder:
      return;  // its writer checks each file
    case PathUse::kWritesWorkspace:
      for (const UsedPath& output : WorkspaceOutputs(path, used_by)) {
        paths->outputs.push_back(output);
      }
  }
}

void CheckKinds(const UsedPaths& paths) {
  for (const UsedPath& input : paths.inputs) CheckInputKind(input.used_by, input.path);
  for (const UsedPath& output : paths.outputs) {
    if (IsPipe(output.path)) {
      throw InputError(
          fmt::format("{}: {} is a pipe, and velamap would wait for its reader; give a file",
                      output.used_by, output.path.string()));
    }
    if (!output.is_replaced_folder && (!output.path.has_filename() || IsFolder(output.path))) {
      throw InputError(fmt::format("{}: {} is a folder; give the name of a file", output.used_by,
                                   output.path.string()));
    }
  }
}

// Throws InputError if the folder in which the output goes, or the first one that has to be made,
// is no folder or is write-protected: before the work whose result would be lost.
void CheckFolderOf(const UsedPath& output) {
  if (Exists(output.path) && !IsFolder(output.path) && !IsRegularFile(output.path)) return;
  fs::path folder = CanonicalPath(output.path).parent_path();
  while (!Exists(folder) && folder.has_relative_path()) folder = folder.parent_path();
  if (!IsFolder(folder)) {
    throw InputError(fmt::format("{}: cannot be written: Not a directory; give another {}",
                                 folder.string(), output.used_by));
  }
  CheckNotProtected(folder);
}

}  // namespace

void CheckInputKind(const std::string& used_by, const fs::path& path) {
  if (!Exists(path) || IsFolder(path) || IsRegularFile(path)) return;
  throw InputError(fmt::format(
      "{}: {} is a pipe or a device, which may never end; give a file, such as a copy of what it "
      "yields",
      used_by, path.string()));
}

std::vector<std::string> PathsFromText(const std::string& text, const std::string& option,
                                       const std::string& example) {
  std::vector<std::string> paths;
  std::istringstream list(text + ",");
  for (std::string path; std::getline(list, path, ',');) {
    if (path.empty() || !Exists(path)) {
      throw InputError(
          fmt::format("{}: '{}' does not exist; give paths separated by commas, such as {}", option,
                      path, example));
    }
    RegisterPrivatePath(path);
    paths.push_back(path);
  }
  return paths;
}

void CompletePaths(const std::vector<OptionGroup>& groups) {
  UsedPaths paths;
  std::vector<UsedPath> named_outputs;  // a workspace checks its folders itself
  for (const OptionGroup& group : groups) {
    for (const Option& option : group.options) {
      const auto* target = std::get_if<std::string*>(&option.target);
      if (target == nullptr) continue;
      std::string* path = *target;
      // Logs are appended to, not replaced.
      const bool is_default_name =
          path->empty() && fs::path(option.name_beside).extension() != ".log";
      if (path->empty() && option.beside != nullptr && !option.beside->empty()) {
        *path = DefaultPath(option).string();
      }
      if (path->empty() || option.path_use == PathUse::kNone) continue;
      RegisterPrivatePath(*path);
      AddUse(option.path_use, "--" + option.name, *path, is_default_name, &paths);
      if (option.path_use == PathUse::kWritesFile || option.path_use == PathUse::kWritesOwnFile ||
          option.path_use == PathUse::kWritesFolder) {
        named_outputs.push_back({"--" + option.name, AbsoluteFolder(*path)});
      }
    }
  }
  CheckKinds(paths);
  CheckOutputs(paths.inputs, paths.outputs);
  for (const UsedPath& output : named_outputs) CheckFolderOf(output);
}

}  // namespace velamap
