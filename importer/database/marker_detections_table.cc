#include "importer/database/marker_detections_table.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/replacement.h"
#include "importer/database/camera_table.h"
#include "importer/database/checked_number.h"
#include "importer/database/colmap_schema.h"
#include "importer/database/sqlite_blob.h"

namespace velamap {
namespace {

constexpr char kDetectionsSchema[] = R"(
CREATE TABLE IF NOT EXISTS marker_detections (
    detection_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL,
    image_id INTEGER NOT NULL,
    frame_number INTEGER,
    time_s REAL,
    marker_id INTEGER,
    part TEXT,
    first_keypoint_idx INTEGER,
    corners BLOB,
    colors BLOB,
    rejected_because TEXT,
    corner_sigmas BLOB,
    is_fallback INTEGER,
    FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
CREATE INDEX IF NOT EXISTS index_marker_detections_image_id ON marker_detections(image_id);
CREATE TABLE IF NOT EXISTS marker_detector (detector TEXT NOT NULL);
)";

// Columns that the first versions of velamap did not have, with their types.
constexpr std::array<std::pair<const char*, const char*>, 2> kAddedColumns = {
    {{"corner_sigmas", "BLOB"}, {"is_fallback", "INTEGER"}}};

class RowWriter {
 public:
  RowWriter(ImageId image_id, const FrameDetections& detections, SQLite::Database* database)
      : insert_(*database,
                "INSERT INTO marker_detections(image_id, frame_number, time_s, marker_id, part,"
                " first_keypoint_idx, corners, colors, rejected_because, corner_sigmas,"
                " is_fallback) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"),
        image_id_(image_id),
        detections_(detections) {}

  // The row of an image without detections holds the image's own columns only.
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
    const std::vector<double> sigmas(marker.corner_sigma_px.begin(), marker.corner_sigma_px.end());
    insert_.bind(4, marker.marker_id);
    if (!marker.part.empty()) insert_.bind(5, marker.part);
    if (first_keypoint_idx) insert_.bind(6, *first_keypoint_idx);
    BindBlob(insert_, 7, corners);
    BindBlob(insert_, 8, colors);
    if (!rejected_because.empty()) insert_.bind(9, rejected_because);
    if (*std::max_element(sigmas.begin(), sigmas.end()) > 0) BindBlob(insert_, 10, sigmas);
    insert_.bind(11, marker.is_fallback ? 1 : 0);
    insert_.exec();
  }

 private:
  void BindImage() {
    insert_.reset();
    insert_.clearBindings();
    insert_.bind(1, image_id_);
    if (detections_.frame_number) insert_.bind(2, *detections_.frame_number);
    if (detections_.time_s) insert_.bind(3, *detections_.time_s);
  }

  SQLite::Statement insert_;
  ImageId image_id_;
  const FrameDetections& detections_;
};

// Writes the row of marker_detector for the first image.
void InsertDetector(const std::string& detector, SQLite::Database* database) {
  const std::optional<std::string> known_detector = ReadDetectorOfDetections(database);
  if (known_detector) {
    VELAMAP_CHECK(*known_detector == detector);
    return;
  }
  SQLite::Statement insert(*database, "INSERT INTO marker_detector(detector) VALUES(?)");
  insert.bind(1, detector);
  insert.exec();
}

// Columns from `begin` on: marker_id, part, corners, colors, corner_sigmas, is_fallback.
MarkerDetection ReadDetection(SQLite::Statement& row, int begin, const std::string& path) {
  const TablePlace place{path, "marker_detections"};
  MarkerDetection marker;
  marker.marker_id = row.getColumn(begin).getInt();
  if (marker.marker_id < 0 || marker.marker_id > kMaxMarkerId) {
    ThrowDamagedTable(place, fmt::format("{} is no marker id", marker.marker_id));
  }
  marker.part = row.getColumn(begin + 1).getString();
  const std::vector<double> corners = ReadBlob<double>(row.getColumn(begin + 2));
  const std::vector<std::uint8_t> colors = ReadBlob<std::uint8_t>(row.getColumn(begin + 3));
  const std::vector<double> sigmas = ReadBlob<double>(row.getColumn(begin + 4));
  if (corners.size() != 2 * kNumCorners || colors.size() != 3 * kNumCorners ||
      (!sigmas.empty() && sigmas.size() != kNumCorners)) {
    ThrowDamagedTable(place,
                      fmt::format("corners, colors or corner_sigmas of marker {} have a wrong size",
                                  marker.marker_id));
  }
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    marker.corners_in_image_px[i] = {corners[2 * i], corners[2 * i + 1]};
    if (!marker.corners_in_image_px[i].allFinite()) {
      ThrowDamagedTable(place,
                        fmt::format("a corner of marker {} is not a number", marker.marker_id));
    }
    marker.colors[i] = {colors[3 * i], colors[3 * i + 1], colors[3 * i + 2]};
  }
  std::copy(sigmas.begin(), sigmas.end(), marker.corner_sigma_px.begin());
  marker.is_fallback = row.getColumn(begin + 5).getInt() != 0;
  return marker;
}

// A photograph has neither frame number nor time.
void ReadTime(const TablePlace& place, SQLite::Statement* row, FrameDetections* frame) {
  constexpr double kMaxTime_s = 1e9;
  constexpr double kMaxFrameNumber = std::numeric_limits<int>::max();
  if (!row->isColumnNull("frame_number")) {
    frame->frame_number =
        static_cast<int>(CheckedNumber(place, "frame_number", FromTo(0, kMaxFrameNumber), row));
  }
  if (!row->isColumnNull("time_s")) {
    frame->time_s = CheckedNumber(place, "time_s", FromTo(-kMaxTime_s, kMaxTime_s), row);
  }
}

}  // namespace

void CreateMarkerDetectionsTable(SQLite::Database* database) {
  database->exec(kDetectionsSchema);
  const std::set<std::string> names = ColumnNames(*database, "marker_detections");
  for (const auto& [name, type] : kAddedColumns) {
    if (names.count(name) > 0) continue;
    database->exec(fmt::format("ALTER TABLE marker_detections ADD COLUMN {} {}", name, type));
  }
  // An earlier velamap repeated the detector in every row.
  if (names.count("detector") == 0) return;
  database->exec(
      "INSERT INTO marker_detector(detector) SELECT detector FROM marker_detections LIMIT 1;"
      "ALTER TABLE marker_detections DROP COLUMN detector");
}

void InsertMarkerDetections(ImageId image_id, const FrameDetections& detections,
                            const std::string& detector, SQLite::Database* database) {
  CreateMarkerDetectionsTable(database);
  InsertDetector(detector, database);
  RowWriter writer(image_id, detections, database);
  for (std::size_t i = 0; i < detections.markers.size(); ++i) {
    writer.Insert(detections.markers[i], kNumCorners * static_cast<int>(i), "");
  }
  for (const RejectedDetection& rejected : detections.rejected) {
    writer.Insert(rejected.detection, std::nullopt, rejected.reason);
  }
  if (detections.markers.empty() && detections.rejected.empty()) writer.InsertNone();
}

std::vector<DatabaseImage> ReadImagesWithDetections(const std::string& path,
                                                    SQLite::Database* database) {
  const std::set<std::string> names = ColumnNames(*database, "marker_detections");
  std::string columns = "marker_id, part, corners, colors";
  for (const auto& [name, type] : kAddedColumns) {
    columns += std::string(", ") + (names.count(name) > 0 ? name : "NULL");
  }
  const std::map<CameraId, Camera> cameras = ReadCameraRows(path, database);
  std::vector<DatabaseImage> images;
  std::set<std::string> image_names;
  SQLite::Statement query(
      *database, fmt::format("SELECT images.image_id, camera_id, name, frame_number, time_s, "
                             "rejected_because, {} FROM images JOIN marker_detections "
                             "USING(image_id) ORDER BY images.image_id, detection_id",
                             columns));
  while (query.executeStep()) {
    const ImageId image_id = query.getColumn(0).getUInt();
    if (images.empty() || images.back().image_id != image_id) {
      DatabaseImage image;
      image.image_id = image_id;
      image.camera_id = query.getColumn(1).getUInt();
      image.detections.image_name = query.getColumn(2).getString();
      CheckImageName(image.detections.image_name, path + ": table images");
      if (!image_names.insert(image.detections.image_name).second) {
        ThrowDamagedTable({path, "images"}, "two images are named " + image.detections.image_name);
      }
      if (cameras.count(image.camera_id) == 0) {
        throw InputError(fmt::format(
            "{}: image {} names camera {}, which the database lacks or has with a model that "
            "velamap does not know; import the pictures again",
            path, image.detections.image_name, image.camera_id));
      }
      ReadTime({path, "marker_detections"}, &query, &image.detections);
      images.push_back(std::move(image));
    }
    if (query.isColumnNull(6)) continue;
    FrameDetections& detections = images.back().detections;
    const MarkerDetection marker = ReadDetection(query, 6, path);
    if (query.isColumnNull(5)) {
      detections.markers.push_back(marker);
    } else {
      detections.rejected.push_back({marker, query.getColumn(5).getString()});
    }
  }
  return images;
}

std::optional<std::string> ReadDetectorOfDetections(SQLite::Database* database) {
  for (const char* table : {"marker_detector", "marker_detections"}) {
    if (!database->tableExists(table) || ColumnNames(*database, table).count("detector") == 0) {
      continue;
    }
    SQLite::Statement query(*database, fmt::format("SELECT detector FROM {} LIMIT 1", table));
    if (query.executeStep()) return query.getColumn(0).getString();
  }
  return std::nullopt;
}

}  // namespace velamap
