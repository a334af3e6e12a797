#include "workflows/check/clip_check.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/database/colmap_database.h"
#include "importer/marker_importer.h"
#include "reconstruct/registration/repeated_frames.h"
#include "workflows/check/clip_frames.h"
#include "workflows/check/clip_ids.h"
#include "workflows/check/clip_light.h"
#include "workflows/check/clip_parts.h"
#include "workflows/check/clip_precision.h"
#include "workflows/check/dictionary_search.h"
#include "workflows/check/marked_frame.h"
#include "workflows/proposal/clip_map.h"
#include "workflows/proposal/layout_correction.h"
#include "workflows/proposal/print_faults.h"
#include "workflows/run/pipeline.h"

namespace velamap {
namespace {

constexpr int kNumFramesWithPixels = 10;
constexpr std::size_t kFewMarkers = 4;

// The layout of the best dictionary; an empty one if none finds markers. The pictures that were
// tried may lack an id, so all ids of the family are searched for.
Layout LayoutOfBestDictionary(const ClipFrames& clip, ArucoDetectionOptions* detection,
                              ClipFacts* facts) {
  const std::vector<DictionaryHint> hints = FindDictionaries(clip, *detection);
  if (hints.empty()) return {};
  facts->num_markers_found = hints[0].num_markers;
  if (hints.size() > 1) {
    facts->num_markers_of_second = hints[1].num_markers;
    facts->second_dictionary = DictionaryName(hints[1]);
  }
  facts->dictionary = hints[0].dictionary;
  Layout layout = UseDictionary(hints[0], detection);
  layout.dictionary = LargestOfFamily(layout.dictionary);
  return layout;
}

bool ShowOnePicture(const std::vector<DatabaseImage>& images) {
  std::vector<const DatabaseImage*> frames;
  for (const DatabaseImage& image : images) frames.push_back(&image);
  const std::vector<bool> is_repeated = FindRepeatedFrames(frames);
  const auto num_repeated = std::count(is_repeated.begin(), is_repeated.end(), true);
  return num_repeated > 0 && num_repeated + 1 == static_cast<std::ptrdiff_t>(frames.size());
}

FrameTimes TimesOf(const ClipFrames& clip, const VideoOptions& video, int num_frames) {
  const Frame &first = clip.frames.front(), &last = clip.frames.back();
  FrameTimes times{video.first_frame, video.frame_step, num_frames, first.time_s.value_or(0.0)};
  if (first.time_s && last.time_s && first.frame_number != last.frame_number) {
    times.seconds_per_frame =
        (*last.time_s - *first.time_s) / (*last.frame_number - *first.frame_number);
  }
  return times;
}

class Checker {
 public:
  explicit Checker(const ClipCheckOptions& options) : options_(options) {}

  ClipCheck Run() {
    ClipFacts& facts = check_.facts;
    facts.num_frames = OpenFrameSource(options_.image_path, options_.video)->NumFrames();
    const VideoOptions video =
        SpreadOverClip(options_.video, facts.num_frames, options_.num_frames);
    const int num_looked_at = facts.num_frames * options_.video.frame_step / video.frame_step;
    const ClipFrames clip = ReadClipFrames(
        options_.image_path, SpreadOverClip(video, num_looked_at, kNumFramesWithPixels),
        kNumFramesWithPixels, options_.num_threads);
    facts.num_frames_read = static_cast<int>(clip.frames.size());
    facts.num_frames_damaged = clip.num_damaged;
    facts.is_video = clip.is_video;
    facts.width_px = clip.frames[0].gray.cols;
    facts.height_px = clip.frames[0].gray.rows;
    facts.has_layout = options_.layout && options_.layout->HasMarkers();
    facts.has_camera = options_.camera.has_value();
    ArucoDetectionOptions detection = options_.detection;
    const Layout layout =
        options_.layout ? *options_.layout : LayoutOfBestDictionary(clip, &detection, &facts);
    if (options_.layout) facts.dictionary = layout.dictionary;
    facts.is_inverted = detection.inverted;
    MarkFrame(clip.frames[0], {});
    if (layout.dictionary.empty()) return std::move(check_);
    Detect(clip, video, layout, detection);
    return std::move(check_);
  }

 private:
  bool MeasuresPrecision() const { return options_.layout.has_value(); }

  void Detect(const ClipFrames& clip, const VideoOptions& video, Layout layout,
              const ArucoDetectionOptions& detection) {
    const TemporaryFolder folder;
    MarkerImporterOptions importer;
    importer.image_path = options_.image_path;
    importer.database_path = (folder.path() / "look.db").string();
    importer.camera = options_.camera;
    importer.camera_path = options_.camera_path;
    importer.layout = layout;
    importer.detection = detection;
    // The estimate takes longer than everything else, and only measuring the markers' sides needs
    // it: without it, they contradict the layout.
    importer.detection.estimate_formation =
        detection.estimate_formation && (MeasuresPrecision() || options_.proposes_layout);
    importer.num_threads = options_.num_threads;
    importer.video = video;
    try {
      const ImportReport report = ImportWithProgress(importer, "looking at frames");
      check_.facts.num_frames_read = report.num_frames_read;
      check_.facts.num_frames_damaged = report.num_frames_damaged;
    } catch (const DataError& error) {
      check_.facts.no_markers_because = error.what();
      layout.dictionary = check_.facts.dictionary;
      CollectIds({}, layout, &check_.facts);
      FindFaults(clip, {}, layout, importer.detection);
      return;
    }
    const ColmapDatabase database(importer.database_path, ColmapDatabase::Mode::kReadOnly);
    const std::vector<DatabaseImage> images = database.ReadImages();
    if (!options_.layout) {
      check_.facts.dictionary = layout.dictionary = DictionaryOfIds(images, layout.dictionary);
    }
    DetectionsByName by_name;
    for (const DatabaseImage& image : images) {
      by_name[image.detections.image_name] = &image.detections;
    }
    CollectFacts(clip, layout, images, by_name);
    check_.facts.shows_one_picture = clip.is_video && ShowOnePicture(images);
    FindFaults(clip, by_name, layout, importer.detection);
    if (options_.proposes_layout) Propose(importer.database_path, layout);
    if (MeasuresPrecision()) Reconstruct(importer.database_path, layout);
    FindParts(clip, video, layout, images);
  }

  void Reconstruct(const std::string& database_path, const Layout& layout) {
    LogInfo("reconstructing the frames for the precision");
    try {
      check_.facts.precision = MeasurePrecision(database_path, layout, options_.num_threads);
    } catch (const DataError& error) {
      check_.facts.no_precision_because = error.what();
    }
  }

  void FindParts(const ClipFrames& clip, const VideoOptions& video, const Layout& layout,
                 std::vector<DatabaseImage> images) {
    ClipFacts& facts = check_.facts;
    if (!clip.is_video) return;
    for (DatabaseImage& image : images) {  // without ids that are probably misread
      std::vector<MarkerDetection>& markers = image.detections.markers;
      const auto is_misread = [&](const MarkerDetection& marker) {
        return facts.num_frames_of_id.count(marker.marker_id) == 0;
      };
      markers.erase(std::remove_if(markers.begin(), markers.end(), is_misread), markers.end());
    }
    const int num_frames = facts.num_frames_read + facts.num_frames_damaged;
    facts.parts = FindClipParts(images, TimesOf(clip, video, num_frames), layout,
                                facts.precision ? &*facts.precision : nullptr);
    if (!facts.shows_one_picture) return;
    for (ClipPart& part : facts.parts) {
      if (part.lacks.empty()) part.lacks = "one picture, repeated";
    }
  }

  // Looks for faulty prints if a layout is proposed, and for faulty pictures if hardly any marker
  // shows.
  void FindFaults(const ClipFrames& clip, const DetectionsByName& by_name, const Layout& layout,
                  const ArucoDetectionOptions& detection) {
    ClipFacts& facts = check_.facts;
    if (!options_.proposes_layout && !facts.MissesMostMarkers()) return;
    LogInfo("looking for mirrored and inverted markers in {} frames", clip.frames.size());
    PrintFaults faults = FindPrintFaults(clip.frames, by_name, layout, detection);
    const std::size_t num_seen = facts.num_frames_of_id.size();
    if (facts.MissesMostMarkers() && faults.mirrored.size() > std::max(kFewMarkers, num_seen)) {
      for (const auto& [marker_id, num_frames] : faults.mirrored) {
        facts.ids_mirrored.push_back(marker_id);
      }
      faults.mirrored.clear();  // the picture is, and not the prints
    }
    if (!options_.proposes_layout) return;
    facts.contradictions =
        DescribeFaults(faults, static_cast<int>(num_seen), static_cast<int>(clip.frames.size()));
  }

  void Propose(const std::string& database_path, const Layout& layout) {
    ClipFacts& facts = check_.facts;
    LogInfo("locating the markers for the layout: this takes as long as a reconstruction");
    try {
      const ClipMap map = MapClip(database_path, layout, options_.num_threads);
      check_.proposal =
          layout.HasMarkers() ? CorrectLayout(map, layout) : ProposeLayout(map, layout);
      for (const std::string& line : map.duplicates) facts.contradictions.push_back(line);
      for (const std::string& line : check_.proposal->contradictions) {
        facts.contradictions.push_back(line);
      }
    } catch (const DataError& error) {
      facts.no_proposal_because = error.what();
    }
  }

  void CollectFacts(const ClipFrames& clip, const Layout& layout,
                    const std::vector<DatabaseImage>& images, const DetectionsByName& by_name) {
    ClipFacts& facts = check_.facts;
    CollectIds(images, layout, &facts);
    std::vector<double> sides_px;
    int num_with_enough = 0;
    for (const DatabaseImage& image : images) {
      num_with_enough += image.detections.markers.size() >= kFewMarkers;
      for (const MarkerDetection& marker : image.detections.markers) {
        sides_px.push_back(QuadMeanSide(marker.corners_in_image_px));
      }
    }
    facts.num_frames_with_few_markers = facts.num_frames_read - num_with_enough;
    facts.side_px = ComputeStatistics(std::move(sides_px));
    MeasureLights(clip, by_name, &facts);
    const FrameDetections* best = nullptr;
    const Frame* best_frame = nullptr;
    for (const Frame& frame : clip.frames) {
      const auto found = by_name.find(frame.image_name);
      if (found == by_name.end()) continue;
      if (best != nullptr && found->second->markers.size() <= best->markers.size()) continue;
      best = found->second;
      best_frame = &frame;
    }
    if (best != nullptr) MarkFrame(*best_frame, *best);
  }

  void MarkFrame(const Frame& frame, const FrameDetections& detections) {
    check_.marked_frame = ColorImage(frame).clone();
    check_.marked_frame_name = frame.image_name;
    DrawMarkers(detections, &check_.marked_frame);
  }

  const ClipCheckOptions& options_;
  ClipCheck check_;
};

}  // namespace

ClipCheck CheckClip(const ClipCheckOptions& options) { return Checker(options).Run(); }

}  // namespace velamap
