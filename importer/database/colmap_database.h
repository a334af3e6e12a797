// The COLMAP database. Only the files of this folder know its tables.
//
// The schema is COLMAP 3.8's (six tables, images with seven nullable prior columns), which every
// COLMAP from 3.5 to 4.x opens. More tables (README.md of this folder) hold what COLMAP has no
// place for; COLMAP ignores and keeps them. The schema of an existing file is recognized by its
// columns.

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
#include "importer/pattern/formation_estimate.h"
#include "importer/video/source_file.h"

namespace SQLite {
class Database;
}

namespace velamap {

struct PartRecord;
struct TrackingState;

// One row of `images` with its detections. Keypoints are the corners of detections.markers, ordered
// by marker id and corner: keypoint_idx = 4 * marker_idx + corner - 1.
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

  // Opens or creates the file. Throws InputError, naming the path, if it is missing (read only), is
  // not an SQLite file, lacks COLMAP's tables, is locked for longer than `busy_timeout_ms`, or, for
  // writing, has the schema of another version, holds images that velamap has not imported, or
  // cannot be written. A file that is refused stays as it is, byte for byte.
  ColmapDatabase(const std::string& path, Mode mode, int busy_timeout_ms = 5000);
  ~ColmapDatabase();

  // Everything that is written between construction and Commit() reaches the file, or nothing does.
  class Transaction {
   public:
    explicit Transaction(ColmapDatabase* database);
    ~Transaction();  // rolls back unless committed
    void Commit();

   private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
  };

  // Adds the camera unless the database holds an equal one. Returns its id. A camera that is not
  // calibrated is only an initial guess, so its prior_focal_length is 0, as COLMAP's own programs
  // write it.
  CameraId AddCamera(const Camera& camera, bool is_calibrated = true);
  std::map<CameraId, Camera> ReadCameras() const;
  // Whether all cameras are calibrated; also true if there are none.
  bool HasCalibration() const;

  // Adds image, keypoints, identity-coding descriptors and marker rows. The name must be new.
  // `detector` says how the detections were made; it must be the same for all images.
  ImageId AddImage(CameraId camera_id, const FrameDetections& detections,
                   const std::string& detector);

  // Replaces keypoints, descriptors and marker rows of an image, and removes its matches, which
  // refer to keypoints by index.
  void ReplaceDetections(ImageId image_id, const FrameDetections& detections,
                         const std::string& detector);

  // Writes `matches` and `two_view_geometries` of a pair, replacing what is there.
  void WriteMatches(ImageId image_id1, ImageId image_id2, const FeatureMatches& matches);

  bool HasMatches(ImageId image_id1, ImageId image_id2) const;

  // Returns all images that velamap imported, by image_id, with the corners in double precision
  // that COLMAP's keypoints do not have. Throws InputError if there are none.
  std::vector<DatabaseImage> ReadImages() const;

  std::map<std::string, ImageId> ReadImageIdsByName() const;

  // Returns how the detections were made (dictionary, refinement, polarity), so that an import can
  // refuse to mix two ways; nothing if there are no detections.
  std::optional<std::string> ReadDetector() const;

  // The image formation (how camera and print displace edges), which is estimated once for all
  // images of a database.
  void WriteFormation(const FormationEstimate& estimate);
  // Throws InputError for values that no estimate gives.
  std::optional<FormationEstimate> ReadFormation() const;

  // The file that an image was read from, or the video (kVideoSource), so that an import can refuse
  // what has changed since.
  void WriteSource(const std::string& image_name, const SourceFile& source);
  std::map<std::string, SourceFile> ReadSources() const;

  // How far a video has been searched.
  void WriteTracking(const TrackingState& state);
  // Throws InputError for values that no tracking gives.
  std::optional<TrackingState> ReadTracking() const;

  // Which part of a video the database holds; nothing if it holds a whole import.
  void WritePart(const PartRecord& record);
  // Throws InputError for values that no import writes.
  std::optional<PartRecord> ReadPart() const;

  // Forgets sources, image formation, tracking and part, which a run that is interrupted before its
  // first images leaves behind.
  void ForgetSources();

 private:
  void OpenForWriting(int busy_timeout_ms);
  void OpenForReading(int busy_timeout_ms);

  struct PairStatements;  // prepared once for all pairs
  PairStatements& Prepared() const;

  std::string path_;
  std::unique_ptr<SQLite::Database> database_;
  mutable std::unique_ptr<PairStatements> pair_statements_;
};

}  // namespace velamap
