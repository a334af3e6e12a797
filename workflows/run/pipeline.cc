#include "workflows/run/pipeline.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/base/log.h"
#include "importer/base/numbers.h"
#include "importer/track/frame_detector.h"
#include "reconstruct/evidence/unnamed_markers.h"
#include "reconstruct/seed_model.h"
#include "reconstruct/thesis/frame_selection.h"
#include "workflows/run/camera_checks.h"
#include "workflows/run/progress.h"
#include "workflows/run/summary.h"

namespace velamap {
namespace {

void FindLeftOut(SeedResult* seed) {
  std::set<std::string> used;
  for (const ModelImage& image : seed->model.images) used.insert(image.name);
  std::map<std::string, LeftOut> with_markers;
  for (const RegisteredFrame& frame : seed->registration.frames) {
    LeftOut& left_out = with_markers[frame.image_name];
    left_out = frame.left_out;
    if (left_out.reason.empty()) left_out.reason = "fewer than two of its markers remain";
  }
  for (const std::string& name : seed->image_names) {
    if (used.count(name) > 0) continue;
    const auto it = with_markers.find(name);
    const LeftOut left_out =
        it == with_markers.end() ? LeftOut{LeftOut::Cause::kUnfit, "no marker found"} : it->second;
    (left_out.IsNotNeeded() ? seed->not_needed : seed->left_out).push_back({name, left_out.reason});
  }
}

// Returns nothing for photographs.
std::optional<ReportClip> ClipOf(const std::vector<DatabaseImage>& images) {
  std::map<int, double> time_of_s;  // by frame number
  for (const DatabaseImage& image : images) {
    const FrameDetections& frame = image.detections;
    if (frame.frame_number && frame.time_s) time_of_s[*frame.frame_number] = *frame.time_s;
  }
  if (time_of_s.size() < 2) return std::nullopt;
  const auto [first, first_s] = *time_of_s.begin();
  const auto [last, last_s] = *time_of_s.rbegin();
  if (!(last_s > first_s)) return std::nullopt;
  const double frames_per_s = (last - first) / (last_s - first_s);
  return ReportClip{frames_per_s, last_s - first_s + 1.0 / frames_per_s};
}

void LogPriorShapeAgreement(const PriorShapeAgreement& agreement) {
  if (agreement.num_known == 0) {
    LogWarning(
        "--prior_shape_path: not used, because no frame shows four of its markers; are its ids "
        "those of the dictionary and the layout?");
    return;
  }
  LogInfo("{} of the {} markers of the prior shape that were found are where it has them",
          agreement.num_agreeing, agreement.num_known);
  if (2 * agreement.num_agreeing < agreement.num_known) {
    LogWarning(
        "--prior_shape_path: the prior shape does not fit these images and was of little use; is "
        "it of this surface, and does the calibration belong to these images?");
  }
}

void LogSeed(const SeedResult& seed) {
  const Registration& registration = seed.registration;
  LogInfo("central frame {}: {}", registration.central_image_name, registration.central_reason);
  for (const std::string& note : registration.notes) LogInfo(note);
  LogInfo("{} of {} images registered, {} markers", seed.model.images.size(),
          seed.image_names.size(), registration.shape.size());
  if (!seed.left_out.empty()) LogInfo("images left out: {}", LeftOutText(seed.left_out));
  if (!seed.not_needed.empty()) LogInfo("images not needed: {}", LeftOutText(seed.not_needed));
  if (const std::string doubt = CameraDoubt(registration); !doubt.empty()) LogWarning(doubt);
  for (const DroppedMarker& marker : registration.dropped_markers) {
    if (marker.is_false) {
      LogWarning("marker {} left out: {}", marker.marker_id, marker.reason);
    } else {
      LogDebug("marker {} left out: {}", marker.marker_id, marker.reason);
    }
  }
}

}  // namespace

VideoOptions NarrowToReach(const VideoOptions& video, const RegistrationOptions& registration) {
  int number = 0;
  if (!ParseNumber(registration.central_frame, &number) || number < 0 ||
      registration.frame_order == FrameOrder::kUnordered ||
      registration.method == RegistrationMethod::kGlobal) {
    return video;
  }
  const auto [first, last] = ReachableFrames(number, registration.thesis);
  VideoOptions narrowed = video;
  // Whole steps from the first frame, so that the same frames are read.
  const int skipped = std::max(0, first - video.first_frame);
  narrowed.first_frame += skipped / video.frame_step * video.frame_step;
  narrowed.last_frame = video.last_frame < 0 ? last : std::min(video.last_frame, last);
  return narrowed;
}

ImportReport ImportWithProgress(const MarkerImporterOptions& options, const std::string& what) {
  Progress sampling("sampling markers for camera and print"),
      formation("estimating camera and print"), frames(what);
  const auto shown_by = [](Progress& progress) {
    return [&progress](int done, int total, const std::string& message) {
      progress.Update(done, total, message);
    };
  };
  return ImportMarkers(options, {shown_by(sampling), shown_by(formation), shown_by(frames)});
}

ImportReport ImportImages(const MarkerImporterOptions& options) {
  const ImportReport report = ImportWithProgress(options, "detecting markers");
  LogInfo("{} images added, {} were in the database before, {} markers found",
          report.num_images_added, report.num_images_present, report.num_markers);
  if (report.num_frames_damaged > 0) {
    LogWarning(
        "{}: the file is damaged: {} frames, which show the damage or depend on it, are left out; "
        "copy it from the camera again, or record again",
        options.image_path, report.num_frames_damaged);
  }
  if (report.num_fallbacks > 0) {
    LogInfo("the corners of {} markers come from cv::cornerSubPix: their edges were not fitted",
            report.num_fallbacks);
  }
  if (!options.prior_shape.empty() && report.num_frames_read > 0)
    LogPriorShapeAgreement(report.prior_shape_agreement);
  if (!report.ids_not_in_layout.empty()) {
    LogInfo("ids that the layout does not name, or that were misread: {}",
            fmt::join(report.ids_not_in_layout, " "));
  }
  return report;
}

void CheckLayoutOfDatabase(const ColmapDatabase& database, const std::string& database_path,
                           const Layout& layout) {
  const std::optional<std::string> detector = database.ReadDetector();
  if (detector) CheckDictionaryOf(*detector, layout, database_path);
}

SeedResult RegisterDatabase(const std::string& database_path, const Layout& layout,
                            const RegistrationOptions& options,
                            const MarkerAdjustmentOptions& adjustment) {
  const ColmapDatabase database(database_path, ColmapDatabase::Mode::kReadOnly);
  CheckLayoutOfDatabase(database, database_path, layout);
  std::vector<DatabaseImage> images = database.ReadImages();
  std::map<CameraId, Camera> cameras = database.ReadCameras();
  SeedResult seed;
  seed.corner_errors = CornerErrorsOf(images, database.ReadFormation());
  if (!database.HasCalibration()) {
    cameras = FindUnknownCameras(cameras, layout, seed.corner_errors, options, adjustment, &images);
  }
  for (const auto& [name, image_id] : database.ReadImageIdsByName()) {
    seed.image_names.push_back(name);
  }
  LogInfo("images to register: {}", images.size());
  RegistrationOptions registration = options;
  registration.has_calibration = database.HasCalibration();
  seed.registration = RegisterFrames(images, cameras, layout, registration);
  seed.model = MakeSeedModel(seed.registration, images, cameras);
  FindLeftOut(&seed);
  std::set<int> ids;
  for (const DatabaseImage& image : images) {
    for (const MarkerDetection& marker : image.detections.markers) ids.insert(marker.marker_id);
  }
  seed.num_ids_found = static_cast<int>(ids.size());
  seed.clip = ClipOf(images);
  LogSeed(seed);
  const std::vector<int> unnamed = FindUnnamedMarkers(images, seed.model);
  if (!unnamed.empty()) {
    LogWarning("markers left out because the layout does not name them: {}",
               fmt::join(unnamed, " "));
  }
  return seed;
}

}  // namespace velamap
