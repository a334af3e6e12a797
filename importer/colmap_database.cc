#include "importer/colmap_database.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include "importer/colmap_schema.h"
#include "importer/correspondence.h"
#include "importer/error.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

constexpr ImageId kMaxNumImages = 2147483647;
constexpr int kTwoViewConfigCalibrated = 2;  // COLMAP's TwoViewGeometry::CALIBRATED

// One clear line for what SQLite says.
[[noreturn]] void ThrowInputError(const std::string& path, const SQLite::Exception& exception) {
  std::string message;
  switch (exception.getErrorCode()) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      message = "locked by another program; close it (the COLMAP GUI?) and run again";
      break;
    case SQLITE_FULL:
      message = "cannot be written: the disk is full";
      break;
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
      message = "cannot be opened for writing; check the folder and the rights";
      break;
    case SQLITE_NOTADB:
      message = "no SQLite database";
      break;
    case SQLITE_CORRUPT:
      message = "a damaged database; delete it and import again";
      break;
    default:
      message = fmt::format("SQLite reports: {}", exception.what());
  }
  throw InputError(fmt::format("{}: {}", path, message));
}

template <typename Function>
auto Guarded(const std::string& path, const Function& function) {
  try {
    return function();
  } catch (const SQLite::Exception& exception) {
    ThrowInputError(path, exception);
  }
}

template <typename T>
void BindBlob(SQLite::Statement& statement, int index, const std::vector<T>& values) {
  // An empty vector has no address, and SQLite takes a null address for NULL.
  static constexpr char kNothing = 0;
  const void* data = values.empty() ? static_cast<const void*>(&kNothing) : values.data();
  statement.bind(index, data, static_cast<int>(values.size() * sizeof(T)));
}

template <typename T>
std::vector<T> ReadBlob(const SQLite::Column& column) {
  std::vector<T> values(static_cast<std::size_t>(column.getBytes()) / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), column.getBlob(), values.size() * sizeof(T));
  return values;
}

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
  const std::int64_t num_keypoints = static_cast<std::int64_t>(keypoints.size() / 2);
  SQLite::Statement insert_keypoints(
      database, "INSERT INTO keypoints(image_id, rows, cols, data) VALUES(?, ?, 2, ?)");
  insert_keypoints.bind(1, image_id);
  insert_keypoints.bind(2, num_keypoints);
  BindBlob(insert_keypoints, 3, keypoints);
  insert_keypoints.exec();
  SQLite::Statement insert_descriptors(
      database, "INSERT INTO descriptors(image_id, rows, cols, data) VALUES(?, ?, 128, ?)");
  insert_descriptors.bind(1, image_id);
  insert_descriptors.bind(2, num_keypoints);
  BindBlob(insert_descriptors, 3, descriptors);
  insert_descriptors.exec();
}

// Writes rows of marker_detections, one for each detection of an image.
class DetectionWriter {
 public:
  DetectionWriter(SQLite::Database& database, ImageId image_id, const FrameDetections& detections,
                  const std::string& detector)
      : insert_(database,
                "INSERT INTO marker_detections(image_id, frame_number, time_s, detector, marker_id,"
                " part, first_keypoint_idx, corners, colors, rejected_because)"
                " VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"),
        image_id_(image_id),
        detections_(detections),
        detector_(detector) {}

  // The row of an image without any detection: nothing but the image's own columns.
  void InsertNone() {
    BindImage();
    insert_.exec();
  }

  void Insert(const MarkerDetection& marker, std::optional<int> first_keypoint_idx,
              const std::string& rejected_because) {
    BindImage();
    std::vector<double> corners;
    std::vector<std::uint8_t> colors;
    for (int i = 0; i < kNumCorners; ++i) {
      const Eigen::Vector2d& x = marker.corners_in_image_px[i];
      corners.insert(corners.end(), {x.x(), x.y()});
      colors.insert(colors.end(), marker.colors[i].begin(), marker.colors[i].end());
    }
    insert_.bind(5, marker.marker_id);
    if (!marker.part.empty()) insert_.bind(6, marker.part);
    if (first_keypoint_idx) insert_.bind(7, *first_keypoint_idx);
    BindBlob(insert_, 8, corners);
    BindBlob(insert_, 9, colors);
    if (!rejected_because.empty()) insert_.bind(10, rejected_because);
    insert_.exec();
  }

 private:
  void BindImage() {
    insert_.reset();
    insert_.clearBindings();
    insert_.bind(1, image_id_);
    if (detections_.frame_number) insert_.bind(2, *detections_.frame_number);
    if (detections_.time_s) insert_.bind(3, *detections_.time_s);
    insert_.bind(4, detector_);
  }

  SQLite::Statement insert_;
  ImageId image_id_;
  const FrameDetections& detections_;
  const std::string& detector_;
};

// Columns from `begin` on: marker_id, part, corners, colors.
MarkerDetection ReadDetection(SQLite::Statement& row, int begin, const std::string& path) {
  MarkerDetection marker;
  marker.marker_id = row.getColumn(begin).getInt();
  marker.part = row.getColumn(begin + 1).getString();
  const std::vector<double> corners = ReadBlob<double>(row.getColumn(begin + 2));
  const std::vector<std::uint8_t> colors = ReadBlob<std::uint8_t>(row.getColumn(begin + 3));
  if (corners.size() != 2 * kNumCorners || colors.size() != 3 * kNumCorners) {
    throw InputError(
        fmt::format("{}: table marker_detections: corners or colors of marker {} have "
                    "a wrong size; delete the database and import again",
                    path, marker.marker_id));
  }
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    marker.corners_in_image_px[i] = {corners[2 * i], corners[2 * i + 1]};
    marker.colors[i] = {colors[3 * i], colors[3 * i + 1], colors[3 * i + 2]};
  }
  return marker;
}

}  // namespace

ColmapDatabase::ColmapDatabase(const std::string& path, Mode mode, int busy_timeout_ms)
    : path_(path) {
  const bool writing = mode == Mode::kReadWriteCreate;
  CheckDatabaseFile(path, writing);
  std::error_code ignored;
  const bool existed = fs::exists(path, ignored);
  try {
    Guarded(path, [&] {
      // A reader that may not write would leave the -wal and -shm files of a database behind that
      // COLMAP has put in write-ahead mode; SQLite itself falls back to reading a protected file.
      const int flags = SQLite::OPEN_READWRITE | (writing ? SQLite::OPEN_CREATE : 0);
      database_ = std::make_unique<SQLite::Database>(path, flags, busy_timeout_ms);
      if (writing) {
        // Takes the write lock at once, so that a locked or read-only file shows itself here.
        SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
        CreateMissingTables(path, database_.get());
        transaction.commit();
      } else {
        database_->exec("PRAGMA query_only = 1");
        CheckColmapTables(path, *database_);
      }
    });
  } catch (...) {
    database_.reset();
    if (!existed) fs::remove(path, ignored);
    throw;
  }
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

CameraId ColmapDatabase::AddCamera(const Camera& camera) {
  for (const auto& [camera_id, known_camera] : ReadCameras()) {
    if (known_camera == camera) return camera_id;
  }
  return Guarded(path_, [&] {
    SQLite::Statement insert(*database_,
                             "INSERT INTO cameras(model, width, height, params,"
                             " prior_focal_length) VALUES(?, ?, ?, ?, 1)");
    insert.bind(1, static_cast<int>(camera.model));
    insert.bind(2, camera.width_px);
    insert.bind(3, camera.height_px);
    BindBlob(insert, 4, camera.params);
    insert.exec();
    return static_cast<CameraId>(database_->getLastInsertRowid());
  });
}

std::map<CameraId, Camera> ColmapDatabase::ReadCameras() const {
  return Guarded(path_, [&] {
    std::map<CameraId, Camera> cameras;
    SQLite::Statement query(*database_,
                            "SELECT camera_id, model, width, height, params"
                            " FROM cameras");
    while (query.executeStep()) {
      Camera camera;
      const std::optional<CameraModel> model = CameraModelFromId(query.getColumn(1).getInt());
      if (!model) continue;  // of an image that velamap has not imported
      camera.model = *model;
      camera.width_px = query.getColumn(2).getInt();
      camera.height_px = query.getColumn(3).getInt();
      camera.params = ReadBlob<double>(query.getColumn(4));
      if (static_cast<int>(camera.params.size()) != NumCameraParams(*model)) {
        throw InputError(fmt::format("{}: camera {} has a wrong number of parameters", path_,
                                     query.getColumn(0).getInt()));
      }
      cameras.emplace(query.getColumn(0).getUInt(), camera);
    }
    return cameras;
  });
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
    DetectionWriter writer(*database_, image_id, detections, detector);
    for (std::size_t i = 0; i < detections.markers.size(); ++i) {
      writer.Insert(detections.markers[i], kNumCorners * static_cast<int>(i), "");
    }
    for (const RejectedDetection& rejected : detections.rejected) {
      writer.Insert(rejected.detection, std::nullopt, rejected.reason);
    }
    if (detections.markers.empty() && detections.rejected.empty()) writer.InsertNone();
    return image_id;
  });
}

void ColmapDatabase::WriteMatches(ImageId image_id1, ImageId image_id2,
                                  const FeatureMatches& matches) {
  VELAMAP_CHECK(image_id1 != image_id2);
  std::vector<std::uint32_t> values;  // the column of the smaller image_id first
  for (const auto& [idx1, idx2] : matches) {
    values.push_back(image_id1 < image_id2 ? idx1 : idx2);
    values.push_back(image_id1 < image_id2 ? idx2 : idx1);
  }
  Guarded(path_, [&] {
    SQLite::Statement insert_matches(
        *database_, "INSERT OR REPLACE INTO matches(pair_id, rows, cols, data) VALUES(?, ?, 2, ?)");
    insert_matches.bind(1, PairId(image_id1, image_id2));
    insert_matches.bind(2, static_cast<std::int64_t>(matches.size()));
    BindBlob(insert_matches, 3, values);
    insert_matches.exec();
    SQLite::Statement insert_geometry(
        *database_,
        "INSERT OR REPLACE INTO two_view_geometries(pair_id, rows, cols, data, config)"
        " VALUES(?, ?, 2, ?, ?)");
    insert_geometry.bind(1, PairId(image_id1, image_id2));
    insert_geometry.bind(2, static_cast<std::int64_t>(matches.size()));
    BindBlob(insert_geometry, 3, values);
    insert_geometry.bind(4, kTwoViewConfigCalibrated);
    insert_geometry.exec();
  });
}

bool ColmapDatabase::HasMatches(ImageId image_id1, ImageId image_id2) const {
  return Guarded(path_, [&] {
    SQLite::Statement query(*database_, "SELECT 1 FROM two_view_geometries WHERE pair_id = ?");
    query.bind(1, PairId(image_id1, image_id2));
    return query.executeStep();
  });
}

std::vector<DatabaseImage> ColmapDatabase::ReadImages() const {
  if (!ReadDetector()) {
    throw InputError(
        fmt::format("{}: holds no marker detections of velamap; import the images "
                    "with velamap marker_importer",
                    path_));
  }
  return Guarded(path_, [&] {
    std::vector<DatabaseImage> images;
    SQLite::Statement query(
        *database_,
        "SELECT images.image_id, camera_id, name, frame_number, time_s, rejected_because,"
        " marker_id, part, corners, colors FROM images JOIN marker_detections USING(image_id)"
        " ORDER BY images.image_id, detection_id");
    while (query.executeStep()) {
      const ImageId image_id = query.getColumn(0).getUInt();
      if (images.empty() || images.back().image_id != image_id) {
        DatabaseImage image;
        image.image_id = image_id;
        image.camera_id = query.getColumn(1).getUInt();
        image.detections.image_name = query.getColumn(2).getString();
        if (!query.isColumnNull(3)) image.detections.frame_number = query.getColumn(3).getInt();
        if (!query.isColumnNull(4)) image.detections.time_s = query.getColumn(4).getDouble();
        images.push_back(std::move(image));
      }
      if (query.isColumnNull(6)) continue;
      FrameDetections& detections = images.back().detections;
      const MarkerDetection marker = ReadDetection(query, 6, path_);
      if (query.isColumnNull(5)) {
        detections.markers.push_back(marker);
      } else {
        detections.rejected.push_back({marker, query.getColumn(5).getString()});
      }
    }
    return images;
  });
}

std::map<std::string, ImageId> ColmapDatabase::ReadImageIdsByName() const {
  return Guarded(path_, [&] {
    std::map<std::string, ImageId> ids;
    SQLite::Statement query(*database_, "SELECT name, image_id FROM images");
    while (query.executeStep()) {
      ids.emplace(query.getColumn(0).getString(), query.getColumn(1).getUInt());
    }
    return ids;
  });
}

std::optional<std::string> ColmapDatabase::ReadDetector() const {
  return Guarded(path_, [&]() -> std::optional<std::string> {
    if (!database_->tableExists("marker_detections")) return std::nullopt;
    SQLite::Statement query(*database_, "SELECT detector FROM marker_detections LIMIT 1");
    if (!query.executeStep()) return std::nullopt;
    return query.getColumn(0).getString();
  });
}

}  // namespace velamap
