// Repeats an import beside an earlier one, which stays as it is until the new one is complete.

#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "importer/marker_importer.h"

namespace velamap {

// The new import is written to a hidden folder beside the database. It takes effect when its
// database is renamed over the earlier one; its frames follow. If a run is killed before the
// rename, the earlier import stays; if it is killed afterwards, the next import completes the
// replacement: CompleteReplacement(). The lock of the database has to be held.
class ImportAnew {
 public:
  // Throws InputError if the database is not one of velamap's, or if a frame would replace a
  // picture of the user's.
  explicit ImportAnew(const MarkerImporterOptions& options);
  ~ImportAnew();  // removes the new import, unless it has replaced the earlier one
  ImportAnew(const ImportAnew&) = delete;
  ImportAnew& operator=(const ImportAnew&) = delete;

  // The options of the import, with the temporary output paths.
  const MarkerImporterOptions& Staged() const { return staged_; }

  // Replaces the database, the frames that the earlier import wrote if those of a video replace
  // them, and, in a workspace, its copies of photographs that have changed since. Call this after
  // closing the new database. Throws InputError if another program has the earlier one open.
  void Replace();

 private:
  // Files of the earlier import that have to be removed: names in the folder of frames.
  std::vector<std::string> ObsoleteFiles() const;

  const MarkerImporterOptions& options_;
  MarkerImporterOptions staged_;
  std::filesystem::path stage_;
  std::vector<std::string> earlier_names_;
  std::map<std::string, SourceFile> earlier_sources_;
  bool has_replaced_ = false;
};

// Cleans up what a killed run has left beside the database: completes a replacement that had begun,
// or removes the unfinished import. The lock of the database has to be held.
void CompleteReplacement(const std::string& database_path);

}  // namespace velamap
