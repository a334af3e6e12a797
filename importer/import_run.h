// One pass over all frames of an import: detects their markers and writes them into the database.

#pragma once

#include <atomic>
#include <mutex>
#include <set>
#include <vector>

#include "importer/database/colmap_database.h"
#include "importer/database/database_writer.h"
#include "importer/database/tracking_table.h"
#include "importer/dictionary_hint.h"
#include "importer/frame_pipeline.h"
#include "importer/frame_turns.h"
#include "importer/marker_importer.h"
#include "importer/track/frame_detector.h"
#include "importer/track/marker_tracking.h"
#include "importer/video/frame_source.h"

namespace velamap {

// Process() runs on many threads, Consume() on one thread in order.
class ImportRun {
 public:
  // `tracking` is the state in which an earlier run has ended. All other arguments must outlive
  // this run.
  ImportRun(const MarkerImporterOptions& options, const FrameDetector& detector,
            const TrackingState& tracking, ColmapDatabase* database, FrameSource* source);

  FrameResult Process(int frame_idx, Frame* frame);
  void Consume(const FrameResult& result);

  // Commits the last batch. Throws InputError if no frame could be read, and DataError if none or
  // hardly any markers were found (CheckMarkersFound()). `cpu_s` is the CPU time that the whole
  // program has spent on the frames, with `num_threads` threads.
  ImportReport Finish(double cpu_s, int num_threads);

 private:
  using Turn = FrameTurns<MarkerTracks>::Turn;

  // Tracks markers from frame to frame, which has to follow the order of the frames. The searches
  // of whole frames, which need no other frame, run before the turn.
  std::vector<MarkerQuad> SearchInTurn(int frame_idx, const Frame& frame, Turn* turn,
                                       FrameResult* result) const;
  // Whether tracking restarts at this frame, as it does at the first frame of a part.
  bool IsFirstOfGroup(int frame_idx) const;
  bool Load(Frame* frame, std::string* reason) const;
  void WriteImage(const Frame& frame, const FrameDetections& detections) const;
  void RecordTracking(const FrameResult& result);
  // The files of a batch have to be on disk before its rows, because a later run does not write the
  // files of frames that the database holds. The tracks after the batch are stored in the same
  // transaction.
  void CommitTrackingWithBatch() const;
  // Covers frames without markers at the end, which are in no batch.
  void CommitTracking() const;
  // Turns sums over threads into the times that ImportReport::times describes.
  void FinalizeTimes(double cpu_s, int num_threads);
  // Called on the working threads, because results that wait for earlier frames hold no pixels.
  void AddToSample(int frame_idx, const cv::Mat& gray);
  void ClearSample();

  const MarkerImporterOptions& options_;
  const FrameDetector& detector_;
  FrameSource* source_;
  ColmapDatabase* database_;
  int num_searched_;        // frames before those of this run
  TrackingState tracking_;  // after the last frame that was consumed
  bool writes_images_;
  DatabaseWriter writer_;
  FrameTurns<MarkerTracks> turns_;  // videos
  bool held_markers_;               // whether the database held markers before this run
  bool expects_markers_;            // whether few markers are a sign of wrong options
  std::atomic<bool> few_found_;     // few markers so far: frames are sampled for a hint
  std::mutex sample_mutex_;
  ImageSample sample_;
  ImportReport report_;
  double reading_s_ = 0.0;
  std::set<int> ids_not_in_layout_;
};

}  // namespace velamap
