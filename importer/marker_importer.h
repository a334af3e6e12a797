// The entry point of the importer: from frames to a COLMAP database.

#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "importer/base/stage_timer.h"
#include "importer/camera/camera.h"
#include "importer/database/part_table.h"
#include "importer/detect/chessboard.h"
#include "importer/detect/detection_options.h"
#include "importer/layout/layout.h"
#include "importer/layout/prior_shape.h"
#include "importer/video/video_options.h"

namespace velamap {

// Called with the numbers of frames done and in total (0 if unknown) and a line on the last frame:
// with none done where the reading of frames begins, then after each.
using ProgressCallback = std::function<void(int done, int total, const std::string& message)>;

struct MarkerImporterOptions {
  std::string image_path;     // folder of images, or a video file
  std::string database_path;  // created, or added to
  // For one image size; scaled for frames of the same aspect ratio, and turned as EXIF says.
  // Nothing: it is not known, the database gets a guess, and corners do not depend on it.
  std::optional<Camera> camera;
  std::string camera_path;  // for messages only
  Layout layout;
  ArucoDetectionOptions detection;
  VideoOptions video;
  PriorShape prior_shape;  // empty: none
  // Its squares are the markers, and the layout says only how long they are.
  std::optional<Chessboard> chessboard;
  // Video only: the folder into which frames with markers are written as JPEG, so that later steps
  // need not decode the video again; empty: none are written. Photographs stay where they are.
  std::string frame_output_path;
  // Whether the database must hold nothing of other folders or videos, nor frames that
  // `allowed_frames` leaves out, of which `video` may choose fewer.
  bool is_only_source = false;
  VideoOptions allowed_frames;
  // Video only: the part of the frames to import, for MergeDatabases(); nothing: all. No marker in
  // a part is no error.
  std::optional<VideoPart> part;
  // Whether all is imported again, beside an earlier import, which it replaces when it is whole:
  // the database, and the pictures that it made.
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
  int num_markers = 0;                 // detections accepted in this run
  int num_rejected = 0;                // detections rejected in this run
  int num_fallbacks = 0;               // accepted without a corner fit: corners of cv::cornerSubPix
  int num_pairs = 0;                   // image pairs with matches
  PriorShapeAgreement prior_shape;     // of all frames
  std::vector<int> ids_not_in_layout;  // detected and rejected, because no part names them
  std::vector<SkippedImage> skipped;   // unreadable files
  // Frames of a video that were left out because the file is damaged there or before them, those of
  // an earlier import of the same frames among them.
  int num_frames_damaged = 0;
  // CPU times are sums over the threads. Decoding has the CPU time that no other stage claims,
  // because FFmpeg decodes on threads of its own. The stages overlap, so wall times are those of
  // the reading thread (decode), the mean of the working threads (detect, refine, images) and those
  // of the calling thread (database).
  ImportTimes times;
};

// Streams frames through a bounded queue, detects their markers on all cores, resolves duplicates,
// rejects ids that the layout does not name, and writes the images in order and in batches. The
// steps that need all frames follow (import_completion.h). Frames whose name is in the database
// are skipped.
//
// Throws InputError for unreadable input, a calibration for another image size, a prior shape
// without a calibration, a layout whose ids the dictionary does not have, a database that was made
// with another camera, other detector settings or pictures that have changed since, one that
// another velamap imports into, and a frame that would replace a picture that velamap did not
// write. What an earlier import made stays as it is where a new one (import_anew) fails. Throws
// DataError that names the dictionaries and polarity that would have found markers if there are
// none.
ImportReport ImportMarkers(const MarkerImporterOptions& options,
                           const ProgressCallback& progress = {});

}  // namespace velamap
