// The room's door: frames in, COLMAP database out.

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "importer/base/stage_timer.h"
#include "importer/camera/camera.h"
#include "importer/detect/detection_options.h"
#include "importer/layout/layout.h"
#include "importer/layout/prior_shape.h"
#include "importer/video/video_options.h"

namespace velamap {

// Called with work done and total (0 if unknown) and a short line on what was done last.
using ProgressCallback = std::function<void(int done, int total, const std::string& message)>;

struct MarkerImporterOptions {
  std::string image_path;     // folder of images, or a video file
  std::string database_path;  // created, or added to
  Camera camera;            // for one image size; scaled where the frames' differs by a pure scale
  std::string camera_path;  // only for messages
  Layout layout;
  ArucoDetectionOptions detection;
  VideoOptions video;
  PriorShape prior_shape;  // empty: none
  // Video only: folder for the frames that hold markers, as JPEG, so that a later step can show
  // them without decoding the video again; empty: none are written. Photographs stay where they
  // are.
  std::string frame_output_path;
  int num_threads = 0;  // 0: one a core
};

struct SkippedImage {
  std::string image_name;
  std::string reason;
};

struct ImportReport {
  int num_frames_read = 0;     // decoded in this run
  int num_images_added = 0;    // rows added to the database
  int num_images_present = 0;  // were there before
  int num_images_without_markers = 0;
  int num_markers = 0;    // detections accepted in this run
  int num_rejected = 0;   // detections left out in this run
  int num_fallbacks = 0;  // accepted ones whose corner fit failed: cv::cornerSubPix's corners
  int num_pairs = 0;      // pairs of images with matches
  PriorShapeAgreement prior_shape;     // of all frames
  std::vector<int> ids_not_in_layout;  // found, not named by the layout, left out
  std::vector<SkippedImage> skipped;   // unreadable files
  // CPU time summed over the threads; that of decoding is what no other stage claims, because
  // FFmpeg decodes on threads of its own. The stages overlap: their wall times are those of the
  // reading thread (decode), of one of the working threads in the mean (detect, refine, images) and
  // of the calling one (database).
  ImportTimes times;
};

// Detects the markers of every frame on all cores while frames stream through a bounded queue,
// resolves duplicates, leaves out ids that the layout does not name, and writes images in order in
// batches; then what needs all frames (import_completion.h). Frames that the database already holds
// (by name) are left as they are.
//
// Throws InputError (unreadable input, calibration for another size, a database made with another
// camera or detector settings) and DataError: no marker found at all, naming the dictionaries and
// polarity that would have found some.
ImportReport ImportMarkers(const MarkerImporterOptions& options,
                           const ProgressCallback& progress = {});

}  // namespace velamap
