#include "importer/database/database_writer.h"

#include "importer/base/files.h"
#include "importer/database/source_table.h"

namespace velamap {
namespace {

constexpr int kBatchSize = 50;  // images per transaction

}  // namespace

std::filesystem::path LockOfDatabase(const std::string& path) {
  const std::filesystem::path file = CanonicalPath(path);
  return file.parent_path() / ("." + file.filename().string() + ".lock");
}

NewDatabaseGuard::NewDatabaseGuard(const std::string& path)
    : path_(CanonicalPath(path).string()), is_new_(!Exists(path)) {}

NewDatabaseGuard::~NewDatabaseGuard() {
  if (!is_new_) return;
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) RemoveAll(path_ + suffix);
}

DatabaseWriter::DatabaseWriter(const std::string& detector, const std::optional<SourceFile>& video,
                               const std::function<void()>& before_commit, ColmapDatabase* database)
    : detector_(detector), video_(video), before_commit_(before_commit), database_(database) {}

void DatabaseWriter::Add(const FrameDetections& detections, const Camera& camera,
                         bool is_calibrated, const std::optional<SourceFile>& source) {
  if (!transaction_) transaction_.emplace(database_);
  database_->AddImage(database_->AddCamera(camera, is_calibrated), detections, detector_);
  if (video_) database_->WriteSource(kVideoSource, *video_);
  video_.reset();
  if (source) database_->WriteSource(detections.image_name, *source);
  if (++num_in_batch_ == kBatchSize) Commit();
}

void DatabaseWriter::Commit() {
  if (transaction_) {
    before_commit_();
    transaction_->Commit();
  }
  transaction_.reset();
  num_in_batch_ = 0;
}

}  // namespace velamap
