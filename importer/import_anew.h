// Imports anew beside an earlier import, which stays as it is until the new one is whole.

#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "importer/marker_importer.h"

namespace velamap {

// The new import grows in a hidden folder beside the database. The rename of its database over the
// earlier one is the moment from which on the new one holds; the frames follow. A run that is
// killed before it leaves the earlier import, one that is killed after it is ended by the next
// import: SettleReplacement(). The lock of the database has to be held.
class ImportAnew {
 public:
  // Throws InputError if the database is not one of velamap's, or if a picture of the user stands
  // in the place of a frame.
  explicit ImportAnew(const MarkerImporterOptions& options);
  ~ImportAnew();  // removes the new import, unless it has replaced the earlier one
  ImportAnew(const ImportAnew&) = delete;
  ImportAnew& operator=(const ImportAnew&) = delete;

  // The options of the import, with the places where it is to write.
  const MarkerImporterOptions& Staged() const { return staged_; }

  // Replaces the database, the frames that the earlier import wrote if those of a video replace
  // them, and, in a workspace, its copies of photographs that have changed since. To be called when
  // the new database is closed. Throws InputError if another program works with the earlier one.
  void Replace();

 private:
  // What of the earlier import has to go: names in the folder of frames.
  std::vector<std::string> ObsoleteFiles() const;

  const MarkerImporterOptions& options_;
  MarkerImporterOptions staged_;
  std::filesystem::path stage_;
  std::vector<std::string> earlier_names_;
  std::map<std::string, SourceFile> earlier_sources_;
  bool has_replaced_ = false;
};

// Settles what a killed run has left beside the database: ends a replacement that had begun, and
// else removes the unfinished import. The lock of the database has to be held.
void SettleReplacement(const std::string& database_path);

}  // namespace velamap
