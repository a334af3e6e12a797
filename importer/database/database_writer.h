// The writing side of an import: images in batches, and a new database that is removed if the
// import fails.

#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "importer/camera/camera.h"
#include "importer/database/colmap_database.h"
#include "importer/detect/detection.h"
#include "importer/video/source_file.h"

namespace velamap {

// The lock of the runs that write to a database. It lies beside the file itself, so that runs that
// reach the file through different links share it.
std::filesystem::path LockOfDatabase(const std::string& path);

// Removes a database that this run has created, with SQLite's files beside it, unless Keep() was
// called.
class NewDatabaseGuard {
 public:
  explicit NewDatabaseGuard(const std::string& path);  // before the database is opened
  ~NewDatabaseGuard();
  NewDatabaseGuard(const NewDatabaseGuard&) = delete;
  NewDatabaseGuard& operator=(const NewDatabaseGuard&) = delete;

  void Keep() { is_new_ = false; }

 private:
  std::string path_;
  bool is_new_;
};

// Writes images in one transaction per batch.
class DatabaseWriter {
 public:
  // For `detector` see ColmapDatabase::AddImage(). `video` is recorded with the first image.
  // `before_commit` is called before each commit, to bring to disk what the rows refer to.
  DatabaseWriter(const std::string& detector, const std::optional<SourceFile>& video,
                 const std::function<void()>& before_commit, ColmapDatabase* database);

  // `source` is the file of a photograph.
  void Add(const FrameDetections& detections, const Camera& camera, bool is_calibrated,
           const std::optional<SourceFile>& source);
  void Commit();  // the images since the last full batch

 private:
  std::string detector_;
  std::optional<SourceFile> video_;  // until it is recorded
  std::function<void()> before_commit_;
  ColmapDatabase* database_;
  std::optional<ColmapDatabase::Transaction> transaction_;
  int num_in_batch_ = 0;
};

}  // namespace velamap
