// The folder of a whole reconstruction, laid out as COLMAP's users expect:
//
//   database.db  images/  sparse/seed  sparse/0 (refined, metric)  shape/  registration.csv
//   camera.yml (where it was found)  report.html  timing.json  velamap.log  colmap.log

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "importer/base/file_lock.h"
#include "importer/base/replacement.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct WorkspacePaths {
  std::filesystem::path root;  // absolute

  std::filesystem::path Database() const { return root / "database.db"; }
  std::filesystem::path Images() const { return root / "images"; }
  std::filesystem::path Sparse() const { return root / "sparse"; }
  std::filesystem::path Model() const { return root / "sparse" / "0"; }
  std::filesystem::path Shape() const { return root / "shape"; }
  std::filesystem::path RegistrationCsv() const { return root / "registration.csv"; }
  std::filesystem::path Camera() const { return root / "camera.yml"; }
  std::filesystem::path Report() const { return root / "report.html"; }
  std::filesystem::path Timing() const { return root / "timing.json"; }
  std::filesystem::path Log() const { return root / "velamap.log"; }
  std::filesystem::path ColmapLog() const { return root / "colmap.log"; }
};

// The files and folders that every run writes into the workspace `path`. images/ is not one of
// them, because AddModelImages() checks its files one by one, nor is camera.yml, which is written
// only without --camera_path. `used_by` names the option.
std::vector<UsedPath> WorkspaceOutputs(const std::string& path, const std::string& used_by);

// Holds the workspace during a run, and its lock. Unless Keep() is called, the destructor removes a
// folder that this run made and the parents that it made, so that a run that fails before it has a
// database leaves nothing behind.
class Workspace {
 public:
  // Opens an earlier workspace or makes a new one. Throws InputError if the path is a file or lies
  // in the folder of the photographs, if the folder is no workspace and holds anything but the
  // input, if another velamap works there, or if it cannot be written.
  Workspace(const std::string& path, const std::string& image_path);
  ~Workspace();
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  const WorkspacePaths& paths() const { return paths_; }
  void Keep() { first_made_.reset(); }

 private:
  WorkspacePaths paths_;
  std::optional<std::filesystem::path> first_made_;  // topmost folder that this run made
  std::optional<FileLock> lock_;
};

// Copies the photographs of the model from `image_path` to images/, with their sub-folders.
// Existing files stay; a photograph of another size than the original gives a warning. Frames of a
// video were written by the import. Images of the model that are missing, for example frames that
// an earlier run removed, give a warning. Throws InputError if the folder cannot be written.
void AddModelImages(const Model& model, const std::string& image_path,
                    const std::filesystem::path& images_path);

// Removes images that are in the database but not in the model where nothing is lost: frames of a
// video as velamap wrote them, and photographs that are equal to the original at `image_path`.
void RemoveOtherImages(const Model& model, const std::vector<std::string>& database_names,
                       const std::string& image_path, const std::filesystem::path& images_path);

}  // namespace velamap
