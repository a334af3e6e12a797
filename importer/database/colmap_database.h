// The COLMAP database: the only file of velamap that knows its tables.
//
// Layout: COLMAP 3.8's (six tables, images with seven nullable prior columns), which every COLMAP
// from 3.5 to 4.x opens. One extra table, marker_detections, holds what COLMAP has no place for;
// COLMAP ignores and keeps it. The layout of an existing file is recognised by its columns.

#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "importer/base/ids.h"
#include "importer/camera/camera.h"
#include "importer/detect/detection.h"

namespace SQLite {
class Database;
}

namespace velamap {

// One row of `images` with its detections. Keypoints are the corners of detections.markers in
// order of marker id then corner: keypoint_idx = 4 * position of the marker + corner - 1.
struct DatabaseImage {
  ImageId image_id = 0;
  CameraId camera_id = 0;
  FrameDetections detections;
};

// Matches of one pair as (keypoint_idx in the first image, keypoint_idx in the second).
using FeatureMatches = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

class ColmapDatabase {
 public:
  enum class Mode { kReadOnly, kReadWriteCreate };

  // Opens or creates the file. Throws InputError, naming the path, if it is missing (read only), no
  // SQLite file, lacks COLMAP's tables, has an unknown layout, is locked for longer than
  // `busy_timeout_ms`, or cannot be written.
  ColmapDatabase(const std::string& path, Mode mode, int busy_timeout_ms = 5000);
  ~ColmapDatabase();

  // All statements between Begin() and Commit() are written or none is.
  class Transaction {
   public:
    explicit Transaction(ColmapDatabase* database);
    ~Transaction();  // rolls back unless committed
    void Commit();

   private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
  };

  // Adds the camera, or returns the id of an equal one that is there.
  CameraId AddCamera(const Camera& camera);
  std::map<CameraId, Camera> ReadCameras() const;

  // Adds image, keypoints, identity-coding descriptors and marker rows. The name must be new.
  // `detector` says how the detections were made; see ReadDetector().
  ImageId AddImage(CameraId camera_id, const FrameDetections& detections,
                   const std::string& detector);

  // Writes keypoints, descriptors and marker rows of an image anew. Its matches with other images
  // go: they name keypoints by their place.
  void ReplaceDetections(ImageId image_id, const FrameDetections& detections,
                         const std::string& detector);

  // Writes `matches` and `two_view_geometries` of a pair, replacing what is there.
  void WriteMatches(ImageId image_id1, ImageId image_id2, const FeatureMatches& matches);

  bool HasMatches(ImageId image_id1, ImageId image_id2) const;

  // All images that velamap imported, by image_id. Detections carry the exact double corners of
  // our table. Throws InputError when the database holds no marker detections of velamap.
  std::vector<DatabaseImage> ReadImages() const;

  std::map<std::string, ImageId> ReadImageIdsByName() const;

  // How the detections that are there were made (dictionary, refinement, polarity), so that one
  // database never mixes two ways; nothing in a database without detections.
  std::optional<std::string> ReadDetector() const;

 private:
  struct PairStatements;  // prepared once for all pairs
  PairStatements& Prepared() const;

  std::string path_;
  std::unique_ptr<SQLite::Database> database_;
  mutable std::unique_ptr<PairStatements> pair_statements_;
};

}  // namespace velamap
