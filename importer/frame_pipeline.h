// Passes frames from one reading thread through many working threads to the caller, in order.

#pragma once

#include <functional>
#include <optional>
#include <string>

#include "importer/base/stage_timer.h"
#include "importer/camera/camera.h"
#include "importer/detect/detection.h"
#include "importer/layout/prior_shape.h"
#include "importer/track/marker_tracking.h"
#include "importer/video/frame_source.h"

namespace velamap {

struct FrameResult {
  FrameDetections detections;
  Camera camera;                              // for the frame's size
  std::string skipped_because;                // not empty: the file was not a complete image
  bool is_damaged = false;                    // skipped, because a video is damaged there
  std::optional<SourceFile> source;           // of a photograph
  PriorShapeAgreement prior_shape_agreement;  // of the markers that were found without it
  std::optional<MarkerTracks> tracks;         // of a video, after this frame
  ImportTimes times;                          // of the thread that processed it
  double reading_s = 0.0;                     // Frame::reading_s
};

// Reads all frames of `source`, calls `process` for each on up to `num_threads` threads (frame_idx
// counts from 0) and `consume` with the results in order on the calling thread. If the system
// refuses a thread, the threads that have started do the work; throws InputError if there are fewer
// than two. No more than 2 num_threads + 1 frames are in memory. The first exception of reading,
// `process` or `consume` ends all threads and is rethrown. OpenCV starts no threads
// (UseOwnThreadsOnly()).
void RunFramePipeline(FrameSource* source, int num_threads,
                      const std::function<FrameResult(int frame_idx, Frame* frame)>& process,
                      const std::function<void(int frame_idx, FrameResult result)>& consume);

}  // namespace velamap
