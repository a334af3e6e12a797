// The writing side of an import: a database that is there whole or not at all, and images in
// batches.

#pragma once

#include <optional>
#include <string>

#include "importer/camera/camera.h"
#include "importer/database/colmap_database.h"
#include "importer/detect/detection.h"

namespace velamap {

// Removes a database that this run creates unless Keep() was called.
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

// One transaction a batch of images.
class DatabaseWriter {
 public:
  // `detector` as ColmapDatabase::AddImage() wants it.
  DatabaseWriter(const std::string& detector, ColmapDatabase* database);

  void Add(const FrameDetections& detections, const Camera& camera);
  void Commit();  // what is left

 private:
  std::string detector_;
  ColmapDatabase* database_;
  std::optional<ColmapDatabase::Transaction> transaction_;
  int num_in_batch_ = 0;
};

}  // namespace velamap
