#include "importer/import_run.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/stage_timer.h"
#include "importer/frame_camera.h"
#include "importer/import_checks.h"
#include "importer/import_part.h"
#include "importer/rotation/rotation_ambiguity.h"
#include "importer/video/source_file.h"
#include "importer/video/written_frame.h"

namespace velamap {
namespace {

bool HoldsMarkers(const ColmapDatabase& database) {
  if (!database.ReadDetector()) return false;
  const std::vector<DatabaseImage> images = database.ReadImages();
  return std::any_of(images.begin(), images.end(),
                     [](const DatabaseImage& image) { return !image.detections.markers.empty(); });
}

}  // namespace

ImportRun::ImportRun(const MarkerImporterOptions& options, const FrameDetector& detector,
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
          source->IsVideo() ? std::make_optional(IdentifySource(options.image_path)) : std::nullopt,
          [this] { CommitTrackingWithBatch(); }, database),
      turns_(tracking.tracks),
      held_markers_(HoldsMarkers(*database)),
      expects_markers_(!held_markers_ && !options.part),
      few_found_(expects_markers_) {}

FrameResult ImportRun::Process(int frame_idx, Frame* frame) {
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
               : SearchInWholeFrame(detector_, result.camera, frame->gray,
                                    &result.prior_shape_agreement);
      result.detections = DetectInFrame(detector_, *frame, result.camera, quads);
    }
    WriteImage(*frame, result.detections);
    AddToSample(frame_idx, frame->gray);
    result.source = frame->source;
  }
  result.is_damaged = !frame->is_whole;
  if (result.is_damaged && turn && IsFirstOfGroup(frame_idx)) {
    *turn->Wait() = {};
    result.tracks = MarkerTracks{};
  }
  result.times = TakeStageTimes();
  result.reading_s = frame->reading_s;
  return result;
}

void ImportRun::Consume(const FrameResult& result) {
  const StageTimer timer(ImportStage::kDatabase);
  RecordTracking(result);
  report_.times += result.times;
  reading_s_ += result.reading_s;
  const FrameDetections& detections = result.detections;
  if (result.is_damaged) return;
  if (!result.skipped_because.empty()) {
    report_.skipped.push_back({detections.image_name, result.skipped_because});
    return;
  }
  ++report_.num_frames_read;
  report_.num_markers += static_cast<int>(detections.markers.size());
  report_.num_rejected += static_cast<int>(detections.rejected.size());
  report_.prior_shape_agreement += result.prior_shape_agreement;
  report_.num_images_without_markers += detections.markers.empty();
  report_.num_fallbacks += static_cast<int>(
      std::count_if(detections.markers.begin(), detections.markers.end(),
                    [](const MarkerDetection& marker) { return marker.is_fallback; }));
  for (const RejectedDetection& rejected : detections.rejected) {
    report_.num_doubtful_rotations += rejected.reason == kDoubtfulRotation;
    if (rejected.reason != kNotInLayout) continue;
    ++report_.num_not_in_layout;
    ids_not_in_layout_.insert(rejected.detection.marker_id);
  }
  few_found_ =
      expects_markers_ && report_.num_markers < kFewMarkersPerFrame * report_.num_frames_read;
  if (!few_found_) ClearSample();
  // Frames of a video without markers are dropped; a photograph is in the database in any case.
  if (source_->IsVideo() && detections.markers.empty()) return;
  writer_.Add(detections, result.camera, options_.camera.has_value(), result.source);
  ++report_.num_images_added;
}

ImportReport ImportRun::Finish(double cpu_s, int num_threads) {
  const StageTimer timer(ImportStage::kDatabase);
  report_.times += TakeStageTimes();
  FinalizeTimes(cpu_s, num_threads);
  report_.ids_not_in_layout.assign(ids_not_in_layout_.begin(), ids_not_in_layout_.end());
  if (report_.num_frames_read == 0 && !report_.skipped.empty() && !held_markers_) {
    throw InputError(fmt::format("{}: none of {} images can be read; the first: {}: {}",
                                 options_.image_path, report_.skipped.size(),
                                 report_.skipped.front().image_name,
                                 report_.skipped.front().reason));
  }
  report_.num_frames_damaged = tracking_.num_damaged;
  if (report_.num_frames_read == 0 && report_.num_frames_damaged > 0 && !held_markers_ &&
      !options_.part) {
    throw InputError(fmt::format(
        "{}: the file is damaged: none of {} frames is whole; copy it from the camera again",
        options_.image_path, report_.num_frames_damaged));
  }
  if (few_found_) CheckMarkersFound(options_, detector_.dictionary.name, sample_, report_);
  writer_.Commit();
  CommitTracking();
  return report_;
}

std::vector<MarkerQuad> ImportRun::SearchInTurn(int frame_idx, const Frame& frame, Turn* turn,
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
  if (IsFirstOfGroup(frame_idx)) *tracks = {};
  const int frame_number = frame.frame_number.value_or(frame_idx);
  const FrameSearch search{
      frame.gray.size(),
      [&](const auto& regions) { return SearchInFrame(detector_, frame.gray, regions); },
      [&](int marker_id, const QuadCorners& expected, double reach_px) {
        return LocateInFrame(detector_, frame.gray, marker_id, expected, reach_px);
      },
      std::move(seen_coarsely),
      [&](const std::vector<MarkerQuad>& found) {
        return ExpectInFrame(detector_, result->camera, found, &result->prior_shape_agreement);
      }};
  quads = is_full ? CompleteFullSearch(search, std::move(quads), frame_number, tracks)
                  : SearchTracked(search, frame_number, tracks);
  result->tracks = *tracks;
  turn->End();
  return quads;
}

bool ImportRun::IsFirstOfGroup(int frame_idx) const {
  return (num_searched_ + frame_idx) % FramesPerGroup(detector_.options) == 0;
}

bool ImportRun::Load(Frame* frame, std::string* reason) const {
  const StageTimer timer(ImportStage::kDecode);
  return source_->Load(frame, reason);
}

void ImportRun::WriteImage(const Frame& frame, const FrameDetections& detections) const {
  if (!writes_images_ || detections.markers.empty()) return;
  const StageTimer timer(ImportStage::kImages);
  WriteFrameImage(frame, std::filesystem::path(options_.frame_output_path) / frame.image_name);
}

void ImportRun::RecordTracking(const FrameResult& result) {
  ++tracking_.num_frames;
  tracking_.num_damaged += result.is_damaged ? 1 : 0;
  if (const auto number = NumberOfVideoFrame(result.detections.image_name)) {
    tracking_.last_frame = *number;
  }
  if (result.tracks) tracking_.tracks = *result.tracks;
}

void ImportRun::CommitTrackingWithBatch() const {
  if (source_->IsVideo()) database_->WriteTracking(tracking_);
  const StageTimer timer(ImportStage::kImages);
  if (writes_images_ && Exists(options_.frame_output_path)) {
    SyncFileSystem(options_.frame_output_path);
  }
}

void ImportRun::CommitTracking() const {
  if (!source_->IsVideo() || tracking_.num_frames == num_searched_) return;
  ColmapDatabase::Transaction transaction(database_);
  database_->WriteTracking(tracking_);
  transaction.Commit();
}

void ImportRun::FinalizeTimes(double cpu_s, int num_threads) {
  ImportTimes& times = report_.times;
  BusyTime& decode = times[ImportStage::kDecode];
  decode.cpu_s = std::max(0.0, cpu_s - (times.CpuSeconds() - decode.cpu_s));
  for (const ImportStage stage :
       {ImportStage::kDecode, ImportStage::kDetect, ImportStage::kRefine, ImportStage::kImages}) {
    times[stage].wall_s /= num_threads;
  }
  decode.wall_s += reading_s_;
}

void ImportRun::AddToSample(int frame_idx, const cv::Mat& gray) {
  if (!few_found_) return;
  const std::lock_guard<std::mutex> lock(sample_mutex_);
  sample_.Add(frame_idx, gray);
}

void ImportRun::ClearSample() {
  const std::lock_guard<std::mutex> lock(sample_mutex_);
  sample_.Clear();
}

}  // namespace velamap
