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

// The files and folders that every run writes there. images/ is not one of them, because
// AddModelImages() checks its files one by one, nor is camera.yml, which is written only without
// --camera_path. `used_by` names the option.
std::vector<UsedPath> WorkspaceOutputs(const std::string& path, const std::string& used_by);

// Holds the workspace during a run, and its lock. Unless Keep() is called, the destructor removes a
// folder that this run made and the parents that it made, so that a run that fails before it has a
// database leaves nothing behind.
class Workspace {
 public:
  // Opens an earlier workspace or makes a new one. Throws InputError if the path is a file, if the
  // folder holds anything but a workspace of velamap and the input, if another velamap works there,
  // or if it cannot be written.
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

// Adds the images of the model to images/. Photographs are copied from `image_path`; sub-folders
// and files that are there are kept. The import has written the frames of a video there; a later
// run that selects other frames warns of those that have been removed. Throws InputError if the
// folder cannot be written.
void AddModelImages(const Model& model, const std::string& image_path,
                    const std::filesystem::path& images_path);

// Removes images that are in the database but not in the model where nothing is lost: frames of a
// video as velamap wrote them, and photographs that are equal to the original at `image_path`.
void RemoveOtherImages(const Model& model, const std::vector<std::string>& database_names,
                       const std::string& image_path, const std::filesystem::path& images_path);

}  // namespace velamap
