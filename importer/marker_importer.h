// The entry point of the importer: from frames to a COLMAP database.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "importer/base/progress_callback.h"
#include "importer/base/stage_timer.h"
#include "importer/camera/camera.h"
#include "importer/database/part_table.h"
#include "importer/detect/chessboard.h"
#include "importer/detect/detection_options.h"
#include "importer/layout/layout.h"
#include "importer/layout/prior_shape.h"
#include "importer/video/video_options.h"

namespace velamap {

struct MarkerImporterOptions {
  std::string image_path;     // folder of images, or a video file
  std::string database_path;  // created, or added to
  // Calibrated for one image size; scaled for frames of the same aspect ratio, and turned as their
  // EXIF orientation says. Empty if the camera is unknown: the database then gets a guess, which
  // does not affect the corners.
  std::optional<Camera> camera;
  std::string camera_path;  // for messages only
  Layout layout;
  ArucoDetectionOptions detection;
  VideoOptions video;
  PriorShape prior_shape;  // empty: none
  // If set, its squares are the markers, and the layout only gives their length.
  std::optional<Chessboard> chessboard;
  // Video only: the folder into which frames with markers are written as JPEG, so that later steps
  // need not decode the video again; empty: none are written. Photographs stay where they are.
  std::string frame_output_path;
  // Whether the database must hold no images of other folders or videos and no frames outside of
  // `allowed_frames`. `video` may select fewer frames than these.
  bool is_only_source = false;
  VideoOptions allowed_frames;
  // Video only: the part of the frames to import, for MergeDatabases(); empty: all. A part without
  // markers is not an error.
  std::optional<VideoPart> part;
  // Whether everything is imported again. The new database and its pictures replace those of an
  // earlier import when they are complete.
  bool import_anew = false;
  int num_threads = 0;  // 0: one per core
};

struct SkippedImage {
  std::string image_name;
  std::string reason;
};

struct ImportReport {
  int num_frames_read = 0;     // decoded in this run
  int num_images_added = 0;    // to the database
  int num_images_present = 0;  // in the database before this run
  int num_images_without_markers = 0;
  int num_markers = 0;   // detections accepted in this run
  int num_rejected = 0;  // detections rejected in this run
  // Parts of num_rejected: detections that no part of the layout names, and those with the reason
  // kDoubtfulRotation. Both are counted frame by frame; later frames may resolve the latter.
  int num_not_in_layout = 0, num_doubtful_rotations = 0;
  int num_fallbacks = 0;  // accepted without a corner fit: corners of cv::cornerSubPix
  int num_pairs = 0;      // image pairs with matches
  PriorShapeAgreement prior_shape_agreement;  // of all frames
  std::vector<int> ids_not_in_layout;         // detected and rejected, because no part names them
  std::vector<SkippedImage> skipped;          // unreadable files
  // Frames of a video that were left out because the file is damaged there or before them,
  // including those of an earlier import of the same frames.
  int num_frames_damaged = 0;
  // CPU times are sums over the threads. Decoding gets the CPU time that no other stage accounts
  // for, because FFmpeg decodes on threads of its own. The stages after `formation` overlap, so
  // wall times are those of the reading thread (decode), the mean over the working threads (detect,
  // refine, images) and those of the calling thread (database).
  ImportTimes times;
};

struct ImportProgress {
  ProgressCallback sampling;   // of the frames for the estimate of camera and print; any thread
  ProgressCallback formation;  // of the estimate of camera and print; from any thread
  ProgressCallback frames;     // of the frames that are searched for markers
};

// Streams frames through a bounded queue, detects their markers on all cores, resolves duplicates,
// rejects ids that the layout does not name, and writes the images in order and in batches. The
// steps that need all frames follow (import_completion.h). Frames whose name is in the database
// are skipped.
//
// Throws InputError for unreadable input, a calibration for another image size, a prior shape
// without a calibration, a layout with ids that the dictionary does not have, a database that was
// made with another camera, other detector settings or pictures that have changed since, a database
// into which another process imports, and a frame that would replace a picture that velamap did not
// write. If no markers are found, throws DataError that names the dictionaries and polarity that
// would have found some. If an import with import_anew fails, the earlier one stays as it is.
ImportReport ImportMarkers(const MarkerImporterOptions& options,
                           const ImportProgress& progress = {});

}  // namespace velamap
