#include "importer/database_merger.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/file_lock.h"
#include "importer/base/files.h"
#include "importer/base/replacement.h"
#include "importer/database/colmap_database.h"
#include "importer/database/database_writer.h"
#include "importer/database/part_table.h"
#include "importer/database/source_table.h"
#include "importer/database/tracking_table.h"
#include "importer/import_completion.h"
#include "importer/track/frame_detector.h"

namespace velamap {
namespace {

// A part without markers holds no images and no record of camera or video.
struct PartContent {
  std::string path;
  PartRecord record;
  std::vector<DatabaseImage> images;
  std::map<CameraId, Camera> cameras;
  bool is_calibrated = false;
  std::optional<SourceFile> video;
  std::optional<FormationEstimate> formation;
  std::optional<TrackingState> tracking;
};

PartContent ReadContent(const std::string& path) {
  const ColmapDatabase database(path, ColmapDatabase::Mode::kReadOnly);
  const std::optional<PartRecord> record = database.ReadPart();
  if (!record) {
    throw InputError(fmt::format(
        "{}: holds no part of a video; make parts with velamap marker_importer --video_part "
        "1/2 and so on (a whole import needs no merger)",
        path));
  }
  if (!record->is_finished) {
    throw InputError(fmt::format(
        "{}: the import of part {} has not finished; run it again, and it goes on where it ended",
        path, PartText(record->part)));
  }
  PartContent part{
      path, *record, {}, {}, false, {}, database.ReadFormation(), database.ReadTracking()};
  if (!database.ReadDetector()) return part;
  part.images = database.ReadImages();
  part.cameras = database.ReadCameras();
  part.is_calibrated = database.HasCalibration();
  const std::map<std::string, SourceFile> sources = database.ReadSources();
  const auto video = sources.find(kVideoSource);
  if (video != sources.end()) part.video = video->second;
  return part;
}

bool IsSameVideo(const SourceFile& a, const SourceFile& b) {
  return a.size == b.size && a.content_hash == b.content_hash;
}

std::vector<Camera> CamerasOf(const PartContent& part) {
  std::vector<Camera> cameras;
  for (const auto& [camera_id, camera] : part.cameras) cameras.push_back(camera);
  return cameras;
}

// What differs in the imports of two parts; empty if nothing does.
std::string DifferenceOf(const PartContent& a, const PartContent& b) {
  if (a.record.part.count != b.record.part.count) {
    return fmt::format("part {} and part {} are of different splits", PartText(a.record.part),
                       PartText(b.record.part));
  }
  if (!(a.record.whole == b.record.whole)) return "the frames of the whole import differ";
  if (a.record.detector != b.record.detector) {
    return fmt::format("other detection options, another layout or another prior shape ({}; {})",
                       SettingsThatDiffer(a.record.detector, b.record.detector),
                       SettingsThatDiffer(b.record.detector, a.record.detector));
  }
  // Only compares whether there is one: machines differ in the last digits of its values.
  if (a.formation.has_value() != b.formation.has_value()) {
    return "only one holds an estimate of camera and print (table image_formation)";
  }
  if (a.images.empty() || b.images.empty()) return "";
  if (!a.video || !b.video || !IsSameVideo(*a.video, *b.video)) return "another video";
  const bool is_same_camera = CamerasOf(a) == CamerasOf(b) && a.is_calibrated == b.is_calibrated;
  return is_same_camera ? "" : "another camera";
}

// All parts in their order.
std::vector<PartContent> ReadParts(const std::vector<std::string>& paths) {
  if (paths.empty())
    throw InputError("--database_paths: names no database; give the database of each part");
  std::vector<PartContent> parts;
  for (const std::string& path : paths) {
    parts.push_back(ReadContent(path));
  }
  std::stable_sort(parts.begin(), parts.end(), [](const PartContent& a, const PartContent& b) {
    return a.record.part.number < b.record.part.number;
  });
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const std::string difference = DifferenceOf(parts[j], parts[i]);
      if (difference.empty()) continue;
      throw InputError(fmt::format("{}: does not match {}: {}; import both in the same way",
                                   parts[i].path, parts[j].path, difference));
    }
    const VideoPart& part = parts[i].record.part;
    if (i > 0 && part.number == parts[i - 1].record.part.number) {
      throw InputError(fmt::format("{}: holds part {}, which {} also holds; name each part once",
                                   parts[i].path, PartText(part), parts[i - 1].path));
    }
  }
  const int count = parts.front().record.part.count;
  for (int number = 1; number <= count; ++number) {
    const auto idx = static_cast<std::size_t>(number - 1);
    if (idx < parts.size() && parts[idx].record.part.number == number) continue;
    const std::string missing = PartText({number, count});
    throw InputError(
        fmt::format("--database_paths: part {} is missing; name its database, which velamap "
                    "marker_importer --video_part {} makes",
                    missing, missing));
  }
  return parts;
}

FrameDetector DetectorOf(const Layout& layout, const PartContent& part) {
  ArucoDetectionOptions with_lines;
  with_lines.search = SearchMode::kTracked;
  FrameDetector detector = MakeFrameDetector(layout, with_lines);
  if (!IsOfLayout(part.record.detector, detector)) {
    throw InputError(
        fmt::format("--layout_path: not the layout or the dictionary of {}; give the one that the "
                    "parts were imported with",
                    part.path));
  }
  return detector;
}

// The state after the last frame, as if it had been reached from the first one.
std::optional<TrackingState> TrackingOf(const std::vector<PartContent>& parts) {
  std::optional<TrackingState> state;
  int num_frames = 0, num_damaged = 0;
  for (const PartContent& part : parts) {
    if (!part.tracking) continue;
    state = part.tracking;
    num_frames += part.tracking->num_frames;
    num_damaged += part.tracking->num_damaged;
  }
  if (!state) return state;
  state->first_frame = parts.front().record.whole.first_frame;
  state->num_frames = num_frames;
  state->num_damaged = num_damaged;
  return state;
}

// The rows that the imports have written, in the order in which one import writes them.
void WriteParts(const std::vector<PartContent>& parts, ColmapDatabase* database) {
  ColmapDatabase::Transaction transaction(database);
  if (parts.front().formation) database->WriteFormation(*parts.front().formation);
  bool has_video = false;
  std::set<std::string> names;
  for (const PartContent& part : parts) {
    for (const DatabaseImage& image : part.images) {
      const std::string& name = image.detections.image_name;
      if (!names.insert(name).second) {
        throw InputError(fmt::format(
            "{}: image {} is also in an earlier part; import the part again", part.path, name));
      }
      const CameraId camera_id =
          database->AddCamera(part.cameras.at(image.camera_id), part.is_calibrated);
      database->AddImage(camera_id, image.detections, part.record.detector);
    }
    if (part.video && !has_video) database->WriteSource(kVideoSource, *part.video);
    has_video = has_video || part.video;
  }
  const std::optional<TrackingState> tracking = TrackingOf(parts);
  if (tracking) database->WriteTracking(*tracking);
  transaction.Commit();
}

}  // namespace

MergeReport MergeDatabases(const DatabaseMergerOptions& options) {
  std::vector<PartContent> parts = ReadParts(options.database_paths);
  const FrameDetector detector = DetectorOf(options.layout, parts.front());
  MergeReport report;
  for (const PartContent& part : parts) report.num_images += static_cast<int>(part.images.size());
  if (report.num_images == 0) {
    throw DataError(
        fmt::format("{}: no part of the video holds a marker; velamap clip_checker says why",
                    parts.front().path));
  }
  const std::filesystem::path output = CanonicalPath(options.output_path);
  CreateFolders(output.parent_path());
  const FileLock lock(LockOfDatabase(output.string()), output.string());
  // Throws unless velamap may write there.
  if (Exists(output)) ColmapDatabase(output.string(), ColmapDatabase::Mode::kReadWriteCreate);
  const std::string beside = TemporarySibling(output);
  const NewDatabaseGuard guard(beside);  // never kept: removed when it has been copied
  {
    ColmapDatabase database(beside, ColmapDatabase::Mode::kReadWriteCreate);
    WriteParts(parts, &database);
    parts.clear();
    ResolveDoubtfulRotations(detector, &database);
    report.num_pairs = WriteAllMatches(&database);
    for (const DatabaseImage& image : database.ReadImages()) {
      report.num_markers += static_cast<int>(image.detections.markers.size());
    }
  }
  CloneFile(beside, output);
  return report;
}

}  // namespace velamap
