#include "importer/marker_importer.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/file_lock.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/base/parallel.h"
#include "importer/base/stage_timer.h"
#include "importer/database/colmap_database.h"
#include "importer/database/database_writer.h"
#include "importer/database/tracking_table.h"
#include "importer/formation/formation_sampling.h"
#include "importer/frame_camera.h"
#include "importer/frame_pipeline.h"
#include "importer/import_anew.h"
#include "importer/import_checks.h"
#include "importer/import_completion.h"
#include "importer/import_part.h"
#include "importer/import_run.h"
#include "importer/track/frame_detector.h"
#include "importer/video/frame_source.h"

namespace velamap {
namespace {

std::string ProgressLine(const FrameResult& result) {
  const FrameDetections& detections = result.detections;
  if (!result.skipped_because.empty()) return detections.image_name + ": skipped";
  return fmt::format("{}: {} markers", detections.image_name, detections.markers.size());
}

// Returns the estimate in the database, so that later frames are treated like the first ones. If
// there is none, makes one, adds it to the database, and adds the time to `time`.
FormationEstimate FormationOf(const MarkerImporterOptions& options, const FrameDetector& detector,
                              const ImportProgress& progress, ColmapDatabase* database,
                              BusyTime* time) {
  if (const auto known = database->ReadFormation()) return *known;
  const auto camera_of = [&](const Frame& frame) {
    return CameraOfFrame(options, !IsFolder(options.image_path), frame);
  };
  const ProcessTimer timer;
  const FormationEstimate estimate =
      EstimateFormationOfSource(options.image_path, options.video, options.num_threads, detector,
                                camera_of, {progress.sampling, progress.formation});
  database->WriteFormation(estimate);
  TakeStageTimes();  // drops what the search for samples charged to other stages
  *time = timer.Elapsed();
  return estimate;
}

void WarnOfSeveralCameras(const std::string& path, const ColmapDatabase& database) {
  std::set<std::tuple<int, int, double>> kinds;
  for (const auto& [camera_id, camera] : database.ReadCameras()) {
    // Upright and turned pictures are of one camera.
    const auto [smaller, larger] = std::minmax(camera.width_px, camera.height_px);
    kinds.emplace(smaller, larger, MeanFocalLength(camera));
  }
  if (kinds.size() < 2) return;
  LogWarning(
      "{}: holds images of {} cameras or zooms, and one tone curve is estimated for all of them; "
      "if the cameras are of different kinds, import those of each into a database of its own",
      path, kinds.size());
}

// Returns the tracking state of the database. For photographs, and if the earlier import searched
// other frames of the video, returns the state before the first frame.
TrackingState ContinuedTracking(const MarkerImporterOptions& options,
                                const ColmapDatabase& database) {
  TrackingState first;
  first.first_frame = options.video.first_frame;
  first.frame_step = options.video.frame_step;
  if (IsFolder(options.image_path)) return first;
  const std::optional<TrackingState> known = database.ReadTracking();
  const bool is_same =
      known && known->first_frame == first.first_frame && known->frame_step == first.frame_step;
  return is_same ? *known : first;
}

// Adds the names of all frames that have been searched, because the database has no row for those
// without markers.
std::vector<std::string> WithSearchedFrames(std::vector<std::string> known_names,
                                            const TrackingState& tracking) {
  for (std::int64_t number = tracking.first_frame; number <= tracking.last_frame;
       number += tracking.frame_step) {
    known_names.push_back(NameOfVideoFrame(static_cast<int>(number)));
  }
  return known_names;
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
  if (progress) progress(0, source->NumFrames(), "");
  RunFramePipeline(
      source.get(), num_threads,
      [&](int frame_idx, Frame* frame) { return run.Process(frame_idx, frame); },
      [&](int frame_idx, const FrameResult& result) {
        run.Consume(result);
        if (progress) progress(frame_idx + 1, source->NumFrames(), ProgressLine(result));
      });
  return run.Finish(ProcessCpuSeconds() - cpu_begin_s, num_threads);
}

// Runs the steps that need all frames. For a part, the merge does them.
void CompleteDatabase(const MarkerImporterOptions& options, const FrameDetector& detector,
                      ColmapDatabase* database, ImportReport* report) {
  const StageTimer timer(ImportStage::kDatabase);
  RecordPart(options, DescribeDetector(detector), true, database);
  if (options.part) return;
  const int num_turned = ResolveDoubtfulRotations(detector, database);
  report->num_markers += num_turned;
  report->num_rejected -= num_turned;
  report->num_pairs = WriteAllMatches(database);
}

void CheckImporterOptions(const MarkerImporterOptions& options) {
  options.detection.Check();
  options.video.Check();
  if (options.num_threads < 0) {
    throw InputError(
        fmt::format("--num_threads: {} is negative; give 0 for one per core", options.num_threads));
  }
  if (!options.camera && !options.prior_shape.empty()) {
    throw InputError(
        "--prior_shape_path: says where markers are only with a calibration; give --camera_path, "
        "such as the camera.yml of an earlier result, or leave the prior shape out");
  }
  CheckImagePath(options.image_path);
}

// Imports into a database that is new or may be added to, and removes a new one if that fails.
ImportReport ImportInto(const MarkerImporterOptions& options, FrameDetector detector,
                        const std::optional<VideoOptions>& frames, const ImportProgress& progress) {
  NewDatabaseGuard guard(options.database_path);
  ColmapDatabase database(options.database_path, ColmapDatabase::Mode::kReadWriteCreate);
  std::vector<std::string> known_names;
  for (const auto& [name, image_id] : database.ReadImageIdsByName()) known_names.push_back(name);
  if (known_names.empty()) database.ForgetSources();
  CheckSources(options, known_names, database);
  CheckPixelAspect(options);
  CheckPart(options, database);
  CheckSameSettings(options, DescribeDetector(detector), database);
  RecordSources(options, known_names, &database);
  CheckFrameFolder(options, known_names);
  const bool estimates_formation = detector.options.corner_refinement == CornerRefinement::kEdge &&
                                   detector.options.estimate_formation;
  BusyTime formation_time;
  if (estimates_formation) {
    if (frames && known_names.empty()) CheckCalibrationSize(options);
    detector.formation = ImageFormation(
        FormationOf(options, detector, progress, &database, &formation_time).parameters);
  }
  RecordPart(options, DescribeDetector(detector), false, &database);
  ImportReport report;
  if (frames) {
    MarkerImporterOptions searched = options;
    searched.video = *frames;
    report = ImportFrames(searched, detector, known_names, NumThreads(options.num_threads),
                          progress.frames, &database);
    if (estimates_formation) WarnOfSeveralCameras(options.database_path, database);
  }
  report.num_images_present = static_cast<int>(known_names.size());
  CompleteDatabase(options, detector, &database, &report);
  report.times += TakeStageTimes();
  report.times[ImportStage::kFormation] = formation_time;
  guard.Keep();
  return report;
}

}  // namespace

ImportReport ImportMarkers(const MarkerImporterOptions& options, const ImportProgress& progress) {
  TakeStageTimes();  // drops those of an earlier call on this thread
  CheckImporterOptions(options);
  ArucoDetectionOptions detection = options.detection;
  if (IsFolder(options.image_path)) detection.search = SearchMode::kExhaustive;
  const FrameDetector detector =
      options.chessboard ? MakeChessboardDetector(*options.chessboard)
                         : MakeFrameDetector(options.layout, detection, options.prior_shape);
  const std::optional<VideoOptions> frames = FramesToSearch(options);
  CreateFolders(CanonicalPath(options.database_path).parent_path());
  const FileLock lock(LockOfDatabase(options.database_path), options.database_path);
  CompleteReplacement(options.database_path);
  if (!options.import_anew || !Exists(options.database_path)) {
    return ImportInto(options, detector, frames, progress);
  }
  ImportAnew anew(options);
  const ImportReport report = ImportInto(anew.Staged(), detector, frames, progress);
  anew.Replace();
  return report;
}

}  // namespace velamap
