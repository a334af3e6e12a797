#include "importer/marker_importer.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/file_lock.h"
#include "importer/base/files.h"
#include "importer/base/parallel.h"
#include "importer/continued_tracking.h"
#include "importer/database/colmap_database.h"
#include "importer/database/database_writer.h"
#include "importer/dictionary_hint.h"
#include "importer/formation/formation_sampling.h"
#include "importer/frame_camera.h"
#include "importer/frame_pipeline.h"
#include "importer/frame_turns.h"
#include "importer/import_anew.h"
#include "importer/import_checks.h"
#include "importer/import_completion.h"
#include "importer/track/frame_detector.h"
#include "importer/track/marker_tracking.h"
#include "importer/video/frame_image.h"
#include "importer/video/frame_source.h"
#include "importer/video/source_file.h"

namespace velamap {
namespace {

std::string ProgressLine(const FrameResult& result) {
  const FrameDetections& detections = result.detections;
  if (!result.skipped_because.empty()) return detections.image_name + ": skipped";
  return fmt::format("{}: {} markers", detections.image_name, detections.markers.size());
}

bool HoldsMarkers(const ColmapDatabase& database) {
  if (!database.ReadDetector()) return false;
  const std::vector<DatabaseImage> images = database.ReadImages();
  return std::any_of(images.begin(), images.end(),
                     [](const DatabaseImage& image) { return !image.detections.markers.empty(); });
}

// One pass over all frames. Process() runs on many threads, Consume() on one thread in order.
class ImportRun {
 public:
  ImportRun(const MarkerImporterOptions& options, const FrameDetector& detector,
            const TrackingState& tracking, ColmapDatabase* database, FrameSource* source)
      : options_(options),
        detector_(detector),
        source_(source),
        database_(database),
        num_searched_(tracking.num_frames),
        tracking_(tracking),
        writes_images_(source->IsVideo() && !options.frame_output_path.empty()),
        writer_(
            DescribeDetector(detector),
            source->IsVideo() ? std::make_optional(IdentifySource(options.image_path))
                              : std::nullopt,
            [this] { SecureBatch(); }, database),
        turns_(tracking.tracks),
        held_markers_(HoldsMarkers(*database)),
        few_found_(!held_markers_) {}

  FrameResult Process(int frame_idx, Frame* frame) {
    FrameResult result;
    std::optional<Turn> turn;
    if (detector_.options.search == SearchMode::kTracked) turn.emplace(&turns_, frame_idx);
    result.detections.image_name = frame->image_name;
    if (Load(frame, &result.skipped_because)) {
      const StageTimer timer(ImportStage::kDetect);
      result.camera = CameraOfFrame(options_, source_->IsVideo(), *frame);
      if (detector_.chessboard) {
        result.detections = DetectChessboard(*detector_.chessboard, *frame);
      } else {
        const std::vector<MarkerQuad> quads =
            turn ? SearchInTurn(frame_idx, *frame, &*turn, &result)
                 : SearchInWholeFrame(detector_, result.camera, frame->gray, &result.prior_shape);
        result.detections = DetectInFrame(detector_, *frame, frame->gray, quads);
      }
      WriteImage(*frame, result.detections);
      AddToSample(frame_idx, frame->gray);
      result.source = frame->source;
    }
    result.times = TakeStageTimes();
    result.reading_s = frame->decode_s;
    return result;
  }

  void Consume(const FrameResult& result) {
    const StageTimer timer(ImportStage::kDatabase);
    NoteTracking(result);
    report_.times += result.times;
    reading_s_ += result.reading_s;
    const FrameDetections& detections = result.detections;
    if (!result.skipped_because.empty()) {
      report_.skipped.push_back({detections.image_name, result.skipped_because});
      return;
    }
    ++report_.num_frames_read;
    report_.num_markers += static_cast<int>(detections.markers.size());
    report_.num_rejected += static_cast<int>(detections.rejected.size());
    report_.prior_shape += result.prior_shape;
    report_.num_images_without_markers += detections.markers.empty();
    report_.num_fallbacks += static_cast<int>(
        std::count_if(detections.markers.begin(), detections.markers.end(),
                      [](const MarkerDetection& marker) { return marker.is_fallback; }));
    for (const RejectedDetection& rejected : detections.rejected) {
      if (rejected.reason == kNotInLayout) ids_not_in_layout_.insert(rejected.detection.marker_id);
    }
    few_found_ =
        !held_markers_ && report_.num_markers < kFewMarkersPerFrame * report_.num_frames_read;
    if (!few_found_) ClearSample();
    // Frames of a video without markers are dropped; a photograph is in the database in any case.
    if (source_->IsVideo() && detections.markers.empty()) return;
    writer_.Add(detections, result.camera, options_.camera.has_value(), result.source);
    ++report_.num_images_added;
  }

  // Commits the last batch. Throws if the run found nothing. `cpu_s` is the CPU time that the whole
  // program has spent on the frames, with `num_threads` threads.
  ImportReport Finish(double cpu_s, int num_threads) {
    const StageTimer timer(ImportStage::kDatabase);
    report_.times += TakeStageTimes();
    SettleTimes(cpu_s, num_threads);
    report_.ids_not_in_layout.assign(ids_not_in_layout_.begin(), ids_not_in_layout_.end());
    if (report_.num_frames_read == 0 && !report_.skipped.empty() && !held_markers_) {
      throw InputError(fmt::format("{}: none of {} images can be read; the first: {}: {}",
                                   options_.image_path, report_.skipped.size(),
                                   report_.skipped.front().image_name,
                                   report_.skipped.front().reason));
    }
    if (few_found_) CheckMarkersFound(options_, detector_.dictionary.name, sample_, report_);
    writer_.Commit();
    return report_;
  }

 private:
  using Turn = FrameTurns<MarkerTracks>::Turn;

  // Tracks markers from frame to frame, which has to follow the order of the frames. The searches
  // of whole frames, which need no other frame, run before the turn.
  std::vector<MarkerQuad> SearchInTurn(int frame_idx, const Frame& frame, Turn* turn,
                                       FrameResult* result) const {
    std::vector<MarkerQuad> quads, seen_coarsely;
    const int interval = detector_.options.full_search_interval;
    const int phase = (num_searched_ + frame_idx) % interval;
    const bool is_full = phase == 0;
    if (is_full) {
      quads = SearchInFrame(detector_, frame.gray);
    } else if (phase == (interval + 1) / 2) {
      seen_coarsely = SearchInFrameCoarsely(detector_, frame.gray);
    }
    MarkerTracks* tracks = turn->Wait();
    const int frame_number = frame.frame_number.value_or(frame_idx);
    const FrameSearch search{
        frame.gray.size(),
        [&](const auto& regions) { return SearchInFrame(detector_, frame.gray, regions); },
        [&](int marker_id, const QuadCorners& expected, double reach_px) {
          return LocateInFrame(detector_, frame.gray, marker_id, expected, reach_px);
        },
        std::move(seen_coarsely),
        [&](const std::vector<MarkerQuad>& found) {
          return ExpectInFrame(detector_, result->camera, found, &result->prior_shape);
        }};
    quads = is_full ? CompleteFullSearch(search, std::move(quads), frame_number, tracks)
                    : SearchTracked(search, frame_number, tracks);
    result->tracks = *tracks;
    turn->End();
    return quads;
  }

  bool Load(Frame* frame, std::string* reason) const {
    const StageTimer timer(ImportStage::kDecode);
    return source_->Load(frame, reason);
  }

  void WriteImage(const Frame& frame, const FrameDetections& detections) const {
    if (!writes_images_ || detections.markers.empty()) return;
    const StageTimer timer(ImportStage::kImages);
    WriteFrameImage(frame, std::filesystem::path(options_.frame_output_path) / frame.image_name);
  }

  void NoteTracking(const FrameResult& result) {
    ++tracking_.num_frames;
    if (const auto number = NumberOfVideoFrame(result.detections.image_name)) {
      tracking_.last_frame = *number;
    }
    if (result.tracks) tracking_.tracks = *result.tracks;
  }

  // A frame that the database holds is not written again by a later run, so it has to be on the
  // disk first. The batch goes with the tracks after it.
  void SecureBatch() const {
    if (source_->IsVideo()) database_->WriteTracking(tracking_);
    const StageTimer timer(ImportStage::kImages);
    if (writes_images_ && Exists(options_.frame_output_path)) {
      SyncFileSystem(options_.frame_output_path);
    }
  }

  // Turns sums over threads into the times that ImportReport::times describes.
  void SettleTimes(double cpu_s, int num_threads) {
    ImportTimes& times = report_.times;
    BusyTime& decode = times[ImportStage::kDecode];
    decode.cpu_s = std::max(0.0, cpu_s - (times.CpuSeconds() - decode.cpu_s));
    for (const ImportStage stage :
         {ImportStage::kDecode, ImportStage::kDetect, ImportStage::kRefine, ImportStage::kImages}) {
      times[stage].wall_s /= num_threads;
    }
    decode.wall_s += reading_s_;
  }

  // Called on the working threads, because results that wait for earlier frames hold no pixels.
  void AddToSample(int frame_idx, const cv::Mat& gray) {
    if (!few_found_) return;
    const std::lock_guard<std::mutex> lock(sample_mutex_);
    sample_.Add(frame_idx, gray);
  }

  void ClearSample() {
    const std::lock_guard<std::mutex> lock(sample_mutex_);
    sample_.Clear();
  }

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
  std::atomic<bool> few_found_;     // few markers so far: frames are sampled for a hint
  std::mutex sample_mutex_;
  ImageSample sample_;
  ImportReport report_;
  double reading_s_ = 0.0;
  std::set<int> ids_not_in_layout_;
};

// The estimate that the database holds, so that later frames are treated as the first ones were;
// else a new one, which is added to the database.
FormationEstimate FormationOf(const MarkerImporterOptions& options, const FrameDetector& detector,
                              ColmapDatabase* database) {
  if (const auto known = database->ReadFormation()) return *known;
  const FormationEstimate estimate =
      EstimateFormationOfSource(options.image_path, options.video, options.num_threads, detector);
  database->WriteFormation(estimate);
  return estimate;
}

// Imports all frames that the database does not hold. Decoder and pictures are freed at the end,
// because the steps that follow need memory in proportion to the number of frames.
ImportReport ImportFrames(const MarkerImporterOptions& options, const FrameDetector& detector,
                          const std::vector<std::string>& known_names, int num_threads,
                          const ProgressCallback& progress, ColmapDatabase* database) {
  const double cpu_begin_s = ProcessCpuSeconds();
  const TrackingState tracking = ContinuedTracking(options, *database);
  const std::unique_ptr<FrameSource> source =
      OpenFrameSource(options.image_path, options.video, WithSearchedFrames(known_names, tracking),
                      options.num_threads);
  ImportRun run(options, detector, tracking, database, source.get());
  RunFramePipeline(
      source.get(), num_threads,
      [&](int frame_idx, Frame* frame) { return run.Process(frame_idx, frame); },
      [&](int frame_idx, const FrameResult& result) {
        run.Consume(result);
        if (progress) progress(frame_idx + 1, source->NumFrames(), ProgressLine(result));
      });
  return run.Finish(ProcessCpuSeconds() - cpu_begin_s, num_threads);
}

// Beside the database, whatever links lead to it.
std::filesystem::path LockOf(const std::string& database_path) {
  const std::filesystem::path path = CanonicalPath(database_path);
  return path.parent_path() / ("." + path.filename().string() + ".lock");
}

// Runs the steps that need all frames.
void CompleteDatabase(const FrameDetector& detector, ColmapDatabase* database,
                      ImportReport* report) {
  const StageTimer timer(ImportStage::kDatabase);
  const int num_turned = ResolveDoubtfulRotations(detector, database);
  report->num_markers += num_turned;
  report->num_rejected -= num_turned;
  report->num_pairs = WriteAllMatches(database);
}

}  // namespace

ImportReport ImportMarkers(const MarkerImporterOptions& options, const ProgressCallback& progress) {
  TakeStageTimes();  // drops those of an earlier call on this thread
  options.detection.Check();
  options.video.Check();
  if (options.num_threads < 0) {
    throw InputError(
        fmt::format("--num_threads: {} is negative; give 0 for one a core", options.num_threads));
  }
  if (!options.camera && !options.prior_shape.empty()) {
    throw InputError(
        "--prior_shape_path: says where markers are only with a calibration; give --camera_path, "
        "such as the camera.yml of an earlier result, or leave the prior shape out");
  }
  const int num_threads = NumThreads(options.num_threads);
  ArucoDetectionOptions detection = options.detection;
  if (IsFolder(options.image_path)) detection.search = SearchMode::kExhaustive;
  CheckImagePath(options.image_path);
  FrameDetector detector = options.chessboard
                               ? MakeChessboardDetector(*options.chessboard)
                               : MakeFrameDetector(options.layout, detection, options.prior_shape);

  const FileLock lock(LockOf(options.database_path), options.database_path);
  if (options.import_anew) RemoveEarlierImport(options);
  NewDatabaseGuard guard(options.database_path);
  ColmapDatabase database(options.database_path, ColmapDatabase::Mode::kReadWriteCreate);
  std::vector<std::string> known_names;
  for (const auto& [name, image_id] : database.ReadImageIdsByName()) known_names.push_back(name);
  if (known_names.empty()) database.ForgetSources();
  CheckSources(options, known_names, database);
  CheckExisting(options, DescribeDetector(detector), database);
  NoteSources(options, known_names, &database);
  CheckFrameFolder(options, known_names);
  if (detector.options.corner_refinement == CornerRefinement::kEdge &&
      detector.options.estimate_formation) {
    detector.formation = ImageFormation(FormationOf(options, detector, &database).parameters);
  }
  ImportReport report =
      ImportFrames(options, detector, known_names, num_threads, progress, &database);
  report.num_images_present = static_cast<int>(known_names.size());
  CompleteDatabase(detector, &database, &report);
  report.times += TakeStageTimes();
  guard.Keep();
  return report;
}

}  // namespace velamap
