#include "importer/database/camera_table.h"

#include <optional>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/database/sqlite_blob.h"

namespace velamap {

CameraId InsertCamera(const Camera& camera, bool is_calibrated, SQLite::Database* database) {
  SQLite::Statement insert(*database,
                           "INSERT INTO cameras(model, width, height, params,"
                           " prior_focal_length) VALUES(?, ?, ?, ?, ?)");
  insert.bind(1, static_cast<int>(camera.model));
  insert.bind(2, camera.width_px);
  insert.bind(3, camera.height_px);
  BindBlob(insert, 4, camera.params);
  insert.bind(5, is_calibrated ? 1 : 0);
  insert.exec();
  return static_cast<CameraId>(database->getLastInsertRowid());
}

bool AllCamerasAreCalibrated(SQLite::Database* database) {
  const std::string ours =
      database->tableExists("marker_detections")
          ? " AND camera_id NOT IN (SELECT camera_id FROM images WHERE camera_id NOT IN"
            " (SELECT camera_id FROM images JOIN marker_detections USING(image_id)))"
          : "";
  return database->execAndGet("SELECT COUNT(*) FROM cameras WHERE prior_focal_length = 0" + ours)
             .getInt() == 0;
}

std::map<CameraId, Camera> ReadCameraRows(const std::string& path, SQLite::Database* database) {
  std::map<CameraId, Camera> cameras;
  SQLite::Statement query(*database, "SELECT camera_id, model, width, height, params FROM cameras");
  while (query.executeStep()) {
    const std::optional<CameraModel> model = CameraModelFromId(query.getColumn(1).getInt());
    if (!model) continue;
    const Camera camera = {*model, query.getColumn(2).getInt(), query.getColumn(3).getInt(),
                           ReadBlob<double>(query.getColumn(4))};
    const auto fail = [&](const char* what) {
      throw InputError(
          fmt::format("{}: camera {} has {}", path, query.getColumn(0).getInt(), what));
    };
    if (static_cast<int>(camera.params.size()) != NumCameraParams(*model)) {
      fail("a wrong number of parameters");
    }
    if (camera.width_px <= 0 || camera.height_px <= 0) fail("a picture without pixels");
    if (!(SmallestFocalLength(camera) > 0)) fail("a focal length that is not positive");
    cameras.emplace(query.getColumn(0).getUInt(), camera);
  }
  return cameras;
}

}  // namespace velamap
