#include "importer/database/colmap_database.h"

#include <algorithm>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/replacement.h"
#include "importer/database/camera_table.h"
#include "importer/database/checked_number.h"
#include "importer/database/colmap_schema.h"
#include "importer/database/correspondence.h"
#include "importer/database/image_formation_table.h"
#include "importer/database/marker_detections_table.h"
#include "importer/database/part_table.h"
#include "importer/database/source_table.h"
#include "importer/database/sqlite_blob.h"
#include "importer/database/sqlite_errors.h"
#include "importer/database/tracking_table.h"

namespace velamap {
namespace {

constexpr ImageId kMaxNumImages = 2147483647;
constexpr int kTwoViewConfigCalibrated = 2;  // COLMAP's TwoViewGeometry::CALIBRATED

std::int64_t PairId(ImageId image_id1, ImageId image_id2) {
  const auto [first, second] = std::minmax(image_id1, image_id2);
  return static_cast<std::int64_t>(kMaxNumImages) * first + second;
}

void InsertKeypoints(SQLite::Database& database, ImageId image_id,
                     const std::vector<MarkerDetection>& markers) {
  std::vector<float> keypoints;
  std::vector<std::uint8_t> descriptors;
  for (const MarkerDetection& marker : markers) {
    for (int i = 0; i < kNumCorners; ++i) {
      const Eigen::Vector2d& x = marker.corners_in_image_px[i];
      keypoints.insert(keypoints.end(), {static_cast<float>(x.x()), static_cast<float>(x.y())});
      const Descriptor descriptor = EncodeDescriptor({marker.marker_id, i + 1});
      descriptors.insert(descriptors.end(), descriptor.begin(), descriptor.end());
    }
  }
  const auto insert = [&](const char* sql, const auto& values) {
    SQLite::Statement statement(database, sql);
    statement.bind(1, image_id);
    statement.bind(2, static_cast<std::int64_t>(keypoints.size() / 2));
    BindBlob(statement, 3, values);
    statement.exec();
  };
  insert("INSERT INTO keypoints(image_id, rows, cols, data) VALUES(?, ?, 2, ?)", keypoints);
  insert("INSERT INTO descriptors(image_id, rows, cols, data) VALUES(?, ?, 128, ?)", descriptors);
}

}  // namespace

ColmapDatabase::ColmapDatabase(const std::string& path, Mode mode, int busy_timeout_ms)
    : path_(path) {
  const bool writing = mode == Mode::kReadWriteCreate;
  CheckDatabaseFile(path, writing);
  const bool existed = Exists(path);
  try {
    if (existed && writing) CheckUnfinishedCanBeAddedTo(CanonicalPath(path).string());
    Guarded(path,
            [&] { writing ? OpenForWriting(busy_timeout_ms) : OpenForReading(busy_timeout_ms); });
  } catch (...) {
    database_.reset();
    if (!existed) RemoveAll(CanonicalPath(path));
    throw;
  }
}

void ColmapDatabase::OpenForWriting(int busy_timeout_ms) {
  // An absolute path, because SQLite gives names such as :memory: and file:a a special meaning.
  database_ = std::make_unique<SQLite::Database>(
      CanonicalPath(path_).string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, busy_timeout_ms);
  // The matches of a pair take a few kilobytes, which would waste space in pages of the default
  // 4096 bytes. SQLite ignores this setting if the database already has tables.
  database_->exec("PRAGMA page_size = 16384");
  // Acquires the write lock, so that a locked or read-only file is reported here. Does not write to
  // a file that already has tables, so a file that is refused stays as it is.
  SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
  if (IsFresh(*database_)) {
    CreateTables(database_.get());
  } else {
    CheckCanBeAddedTo(path_, database_.get());
  }
  transaction.commit();
}

void ColmapDatabase::OpenForReading(int busy_timeout_ms) {
  const std::string file = CanonicalPath(path_).string();
  const bool has_log = IsRegularFile(file + "-wal") && FileSize(file + "-wal") > 0;
  // A connection without write access would leave -wal and -shm files beside a database that COLMAP
  // has put into write-ahead mode. SQLite falls back to reading if the file is write-protected.
  database_ = std::make_unique<SQLite::Database>(file, SQLite::OPEN_READWRITE, busy_timeout_ms);
  // Does not remove a write-ahead log that another program has written.
  if (has_log) {
    sqlite3_db_config(database_->getHandle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  }
  database_->exec("PRAGMA query_only = 1");
  CheckColmapTables(path_, *database_);
}

ColmapDatabase::~ColmapDatabase() = default;

struct ColmapDatabase::Transaction::Impl {
  std::string path;
  SQLite::Transaction transaction;
};

ColmapDatabase::Transaction::Transaction(ColmapDatabase* database) {
  Guarded(database->path_, [&] {
    impl_.reset(new Impl{
        database->path_,
        SQLite::Transaction(*database->database_, SQLite::TransactionBehavior::IMMEDIATE)});
  });
}

ColmapDatabase::Transaction::~Transaction() = default;

void ColmapDatabase::Transaction::Commit() {
  Guarded(impl_->path, [&] { impl_->transaction.commit(); });
}

CameraId ColmapDatabase::AddCamera(const Camera& camera, bool is_calibrated) {
  for (const auto& [camera_id, known_camera] : ReadCameras()) {
    if (known_camera == camera) return camera_id;
  }
  return Guarded(path_, [&] { return InsertCamera(camera, is_calibrated, database_.get()); });
}

bool ColmapDatabase::HasCalibration() const {
  return Guarded(path_, [&] { return AllCamerasAreCalibrated(database_.get()); });
}

std::map<CameraId, Camera> ColmapDatabase::ReadCameras() const {
  return Guarded(path_, [&] { return ReadCameraRows(path_, database_.get()); });
}

ImageId ColmapDatabase::AddImage(CameraId camera_id, const FrameDetections& detections,
                                 const std::string& detector) {
  return Guarded(path_, [&] {
    SQLite::Statement insert(*database_, "INSERT INTO images(name, camera_id) VALUES(?, ?)");
    insert.bind(1, detections.image_name);
    insert.bind(2, camera_id);
    insert.exec();
    const ImageId image_id = static_cast<ImageId>(database_->getLastInsertRowid());
    InsertKeypoints(*database_, image_id, detections.markers);
    InsertMarkerDetections(image_id, detections, detector, database_.get());
    return image_id;
  });
}

void ColmapDatabase::ReplaceDetections(ImageId image_id, const FrameDetections& detections,
                                       const std::string& detector) {
  Guarded(path_, [&] {
    for (const char* table : {"keypoints", "descriptors", "marker_detections"}) {
      SQLite::Statement remove(*database_, fmt::format("DELETE FROM {} WHERE image_id = ?", table));
      remove.bind(1, image_id);
      remove.exec();
    }
    for (const char* table : {"matches", "two_view_geometries"}) {
      SQLite::Statement remove(
          *database_, fmt::format("DELETE FROM {} WHERE pair_id / {} = ?1 OR pair_id % {} = ?1",
                                  table, kMaxNumImages, kMaxNumImages));
      remove.bind(1, image_id);
      remove.exec();
    }
    InsertKeypoints(*database_, image_id, detections.markers);
    InsertMarkerDetections(image_id, detections, detector, database_.get());
  });
}

struct ColmapDatabase::PairStatements {
  SQLite::Statement find, insert_matches, insert_geometry;
};

ColmapDatabase::PairStatements& ColmapDatabase::Prepared() const {
  if (!pair_statements_) {
    pair_statements_.reset(new PairStatements{
        {*database_, "SELECT 1 FROM two_view_geometries WHERE pair_id = ?"},
        {*database_,
         "INSERT OR REPLACE INTO matches(pair_id, rows, cols, data) VALUES(?, ?, 2, ?)"},
        {*database_,
         "INSERT OR REPLACE INTO two_view_geometries(pair_id, rows, cols, data, config)"
         " VALUES(?, ?, 2, ?, ?)"}});
  }
  return *pair_statements_;
}

void ColmapDatabase::WriteMatches(ImageId image_id1, ImageId image_id2,
                                  const FeatureMatches& matches) {
  VELAMAP_CHECK(image_id1 != image_id2);
  std::vector<std::uint32_t> values;  // the column of the smaller image_id first
  values.reserve(2 * matches.size());
  for (const auto& [idx1, idx2] : matches) {
    values.push_back(image_id1 < image_id2 ? idx1 : idx2);
    values.push_back(image_id1 < image_id2 ? idx2 : idx1);
  }
  Guarded(path_, [&] {
    PairStatements& prepared = Prepared();
    for (SQLite::Statement* insert : {&prepared.insert_matches, &prepared.insert_geometry}) {
      insert->tryReset();
      insert->bind(1, PairId(image_id1, image_id2));
      insert->bind(2, static_cast<std::int64_t>(matches.size()));
      BindBlob(*insert, 3, values);
    }
    prepared.insert_geometry.bind(4, kTwoViewConfigCalibrated);
    prepared.insert_matches.exec();
    prepared.insert_geometry.exec();
  });
}

bool ColmapDatabase::HasMatches(ImageId image_id1, ImageId image_id2) const {
  return Guarded(path_, [&] {
    SQLite::Statement& find = Prepared().find;
    find.bind(1, PairId(image_id1, image_id2));
    const bool has_matches = find.executeStep();
    find.reset();
    return has_matches;
  });
}

std::vector<DatabaseImage> ColmapDatabase::ReadImages() const {
  if (!ReadDetector()) {
    throw InputError(
        fmt::format("{}: holds no marker detections of velamap; import the images "
                    "with velamap marker_importer",
                    path_));
  }
  return Guarded(path_, [&] { return ReadImagesWithDetections(path_, database_.get()); });
}

std::map<std::string, ImageId> ColmapDatabase::ReadImageIdsByName() const {
  return Guarded(path_, [&] {
    std::map<std::string, ImageId> ids;
    SQLite::Statement query(*database_, "SELECT name, image_id FROM images");
    while (query.executeStep()) {
      const std::string name = query.getColumn(0).getString();
      CheckImageName(name, path_ + ": table images");
      if (ids.emplace(name, query.getColumn(1).getUInt()).second) continue;
      ThrowDamagedTable({path_, "images"}, "two images are named " + name);
    }
    return ids;
  });
}

std::optional<std::string> ColmapDatabase::ReadDetector() const {
  return Guarded(path_, [&] { return ReadDetectorOfDetections(database_.get()); });
}

void ColmapDatabase::WriteFormation(const FormationEstimate& estimate) {
  Guarded(path_, [&] { WriteImageFormation(estimate, database_.get()); });
}

std::optional<FormationEstimate> ColmapDatabase::ReadFormation() const {
  return Guarded(path_, [&] { return ReadImageFormation(path_, database_.get()); });
}

void ColmapDatabase::WriteSource(const std::string& image_name, const SourceFile& source) {
  Guarded(path_, [&] { WriteSourceRow(image_name, source, database_.get()); });
}

std::map<std::string, SourceFile> ColmapDatabase::ReadSources() const {
  return Guarded(path_, [&] { return ReadSourceRows(database_.get()); });
}

void ColmapDatabase::WriteTracking(const TrackingState& state) {
  Guarded(path_, [&] { velamap::WriteTracking(state, database_.get()); });
}

std::optional<TrackingState> ColmapDatabase::ReadTracking() const {
  return Guarded(path_, [&] { return velamap::ReadTracking(path_, database_.get()); });
}

void ColmapDatabase::WritePart(const PartRecord& record) {
  Guarded(path_, [&] { velamap::WritePart(record, database_.get()); });
}

std::optional<PartRecord> ColmapDatabase::ReadPart() const {
  return Guarded(path_, [&] { return velamap::ReadPart(path_, database_.get()); });
}

void ColmapDatabase::ForgetSources() {
  Guarded(path_, [&] {
    for (const char* table :
         {"marker_sources", "image_formation", "marker_tracking", "marker_tracks", "marker_part"}) {
      database_->exec(fmt::format("DROP TABLE IF EXISTS {}", table));
    }
  });
}

}  // namespace velamap
