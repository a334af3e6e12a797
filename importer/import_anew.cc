#include "importer/import_anew.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "importer/base/files.h"
#include "importer/database/colmap_database.h"
#include "importer/database/database_writer.h"
#include "importer/import_checks.h"
#include "importer/video/frame_source.h"
#include "importer/video/source_file.h"
#include "importer/video/written_frame.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

void RemoveFrames(const fs::path& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (NumberOfVideoFrame(name) && IsWrittenFrame(folder / name)) RemoveAll(folder / name);
  }
}

// A copy that is as the photograph was when it was imported, while the photograph is another now.
bool IsOutdatedCopy(const fs::path& copy, const fs::path& original, const SourceFile& known) {
  return IsRegularFile(copy) && !IsLink(copy) && IsRegularFile(original) &&
         !IsSameFile(copy, original) && !HasSameContent(known, original.string()) &&
         HasSameContent(known, copy.string());
}

}  // namespace

void RemoveEarlierImport(const MarkerImporterOptions& options) {
  if (!Exists(options.database_path)) return;
  std::vector<std::string> names;
  std::map<std::string, SourceFile> sources;
  {
    const ColmapDatabase database(options.database_path, ColmapDatabase::Mode::kReadWriteCreate);
    for (const auto& [name, image_id] : database.ReadImageIdsByName()) names.push_back(name);
    sources = database.ReadSources();
  }
  OpenFrameSource(options.image_path, options.video, {}, options.num_threads);
  CheckFrameFolder(options, names);
  const fs::path folder = options.frame_output_path;
  std::vector<fs::path> outdated;
  for (const std::string& name : names) {
    const auto known = sources.find(name);
    if (options.is_only_source && known != sources.end() &&
        IsOutdatedCopy(folder / name, fs::path(options.image_path) / name, known->second)) {
      outdated.push_back(folder / name);
    }
  }
  // In this order: only the database tells which copies are outdated, and frames without a database
  // are written anew, while a database without its frames would not notice.
  for (const fs::path& copy : outdated) RemoveAll(copy);
  RemoveDatabase(options.database_path);
  const bool is_video = !IsFolder(options.image_path);  // else the frames may be the photographs
  if (is_video && !folder.empty()) RemoveFrames(folder, names);
}

}  // namespace velamap
