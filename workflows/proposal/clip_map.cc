#include "workflows/proposal/clip_map.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "exporters/scale/metric_shape.h"
#include "exporters/scale/scale_audit.h"
#include "importer/base/error.h"
#include "importer/base/log.h"
#include "importer/base/statistics.h"
#include "importer/database/colmap_database.h"
#include "importer/geometry/quad.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/register_frames.h"
#include "reconstruct/seed_model.h"
#include "workflows/proposal/rare_ids.h"
#include "workflows/run/camera_checks.h"

namespace velamap {
namespace {

constexpr int kMinFrames = 2;  // of a marker that has a place
// A body of fewer markers cannot be told from misread ids.
constexpr std::size_t kMinOnBody = 4;

// The detections as they are without a layout: ids that it does not name count as well.
std::vector<DatabaseImage> WithAllIds(std::vector<DatabaseImage> images) {
  for (DatabaseImage& image : images) {
    std::vector<MarkerDetection>& markers = image.detections.markers;
    std::map<int, std::vector<const MarkerDetection*>> foreign;
    for (const RejectedDetection& rejected : image.detections.rejected) {
      if (rejected.reason != kNotInLayout) continue;
      foreign[rejected.detection.marker_id].push_back(&rejected.detection);
    }
    for (const auto& [marker_id, detections] : foreign) {
      if (detections.size() == 1) markers.push_back(*detections.front());
    }
    std::sort(markers.begin(), markers.end(),
              [](const auto& a, const auto& b) { return a.marker_id < b.marker_id; });
  }
  return images;
}

struct FrameCounts {
  std::map<int, int> num_frames;  // by id
  std::map<int, int> num_twice;   // of these, that show the id at two places at once
};

FrameCounts CountFrames(const std::vector<DatabaseImage>& images) {
  FrameCounts counts{CountFramesOfIds(images), {}};
  for (const DatabaseImage& image : images) {
    std::map<int, std::vector<const MarkerDetection*>> seen;
    for (const MarkerDetection& marker : image.detections.markers) {
      seen[marker.marker_id].push_back(&marker);
    }
    for (const RejectedDetection& rejected : image.detections.rejected) {
      seen[rejected.detection.marker_id].push_back(&rejected.detection);
    }
    for (const auto& [marker_id, detections] : seen) {
      const bool is_twice = std::any_of(detections.begin(), detections.end(),
                                        [&first = *detections.front()](const auto* other) {
                                          return (CornerMean(*other) - CornerMean(first)).norm() >
                                                 QuadMeanSide(first.corners_in_image_px);
                                        });
      if (is_twice) ++counts.num_twice[marker_id];
    }
  }
  return counts;
}

// A quad with a false code is at a different place in every frame and is hardly ever seen twice.
std::vector<std::string> DescribeDuplicates(const FrameCounts& counts) {
  constexpr double kOften = 0.2;
  constexpr int kMinTwice = 3;
  std::vector<std::string> lines;
  for (const auto& [marker_id, num_twice] : counts.num_twice) {
    const int num_frames = counts.num_frames.at(marker_id);
    if (num_twice < std::max<double>(kMinTwice, kOften * num_frames)) continue;
    lines.push_back(
        fmt::format("marker {} occurs twice: {} of its {} frames show it in two places; give one "
                    "of them another id",
                    marker_id, num_twice, num_frames));
  }
  return lines;
}

std::vector<DatabaseImage> Only(std::vector<DatabaseImage> images, const std::set<int>& ids) {
  for (DatabaseImage& image : images) {
    std::vector<MarkerDetection>& markers = image.detections.markers;
    markers.erase(
        std::remove_if(markers.begin(), markers.end(),
                       [&](const auto& marker) { return ids.count(marker.marker_id) == 0; }),
        markers.end());
  }
  return images;
}

// Sets the lengths of markers that are far from their length in the layout. Markers of similar size
// get the median of their lengths. Returns false if there are none.
bool FindOtherLengths(const Registration& registration, Layout* layout) {
  constexpr double kSameSize = 1.1;
  std::vector<std::pair<double, int>> others;  // length, id
  for (const DroppedMarker& marker : registration.dropped_markers) {
    if (!marker.size_ratio) continue;
    others.emplace_back(*marker.size_ratio * MarkerLength(*layout, marker.marker_id),
                        marker.marker_id);
  }
  std::sort(others.begin(), others.end());
  for (std::size_t begin = 0, end = 0; begin < others.size(); begin = end) {
    std::vector<double> lengths_m;
    for (end = begin; end < others.size() &&
                      (end == begin || others[end].first < kSameSize * others[end - 1].first);
         ++end) {
      lengths_m.push_back(others[end].first);
    }
    const double length_m = Median(lengths_m);
    for (std::size_t i = begin; i < end; ++i) layout->marker_lengths_m[others[i].second] = length_m;
  }
  return !others.empty();
}

class Mapper {
 public:
  Mapper(const ColmapDatabase& database, const Layout& layout, int num_threads)
      : formation_(database.ReadFormation()), cameras_(database.ReadCameras()), layout_(layout) {
    // No layout drops a marker here.
    layout_.parts.clear();
    layout_.distances.clear();
    layout_.known_points.clear();
    layout_.reference_part.reset();
    registration_.num_threads = adjustment_.num_threads = num_threads;
    registration_.has_calibration = database.HasCalibration();
    adjustment_.find_camera = !registration_.has_calibration;
    images_ = WithAllIds(database.ReadImages());
    counts_ = CountFrames(images_);
    map_.duplicates = DescribeDuplicates(counts_);
    FindOftenSeen();
    images_ = Only(std::move(images_), often_seen_);
    if (adjustment_.find_camera) {
      cameras_ = FindUnknownCameras(cameras_, layout_, CornerErrorsOf(images_, formation_),
                                    registration_, adjustment_, &images_);
    }
  }

  ClipMap Map() {
    std::set<int> rest = often_seen_;
    for (bool is_first = true; rest.size() >= kMinOnBody; is_first = false) {
      try {
        if (!AddBody(Only(images_, rest))) break;
      } catch (const DataError& error) {
        if (is_first) throw;
        LogDebug("no other body: {}", error.what());
        break;
      }
      for (const auto& [marker_id, points] : map_.bodies.back()) rest.erase(marker_id);
    }
    if (map_.bodies.empty()) {
      throw DataError(fmt::format("fewer than {} markers keep their places relative to each other",
                                  kMinOnBody));
    }
    for (const int marker_id : rest)
      map_.left_out.emplace(marker_id, "the frames do not agree on its place");
    return std::move(map_);
  }

 private:
  // All other ids are left out.
  void FindOftenSeen() {
    const std::set<int> rare = FindRareIds(counts_.num_frames);
    for (const auto& [marker_id, num] : counts_.num_frames) {
      if (rare.count(marker_id) > 0) {
        map_.left_out[marker_id] = "read rarely, probably misread";
      } else if (num < kMinFrames) {
        map_.left_out[marker_id] = "seen in one frame only";
      } else {
        often_seen_.insert(marker_id);
      }
    }
  }

  // Returns whether enough markers keep their places for a body; otherwise all stay left out.
  bool AddBody(const std::vector<DatabaseImage>& images) {
    Layout layout = layout_;
    Registration registration = RegisterFrames(images, cameras_, layout, registration_);
    if (FindOtherLengths(registration, &layout)) {
      registration = RegisterFrames(images, cameras_, layout, registration_);
    }
    Model model = MakeSeedModel(registration, images, cameras_);
    const MarkerAdjustmentSummary summary =
        AdjustWithMarkers(adjustment_, layout, CornerErrorsOf(images, formation_), &model);
    const MarkerShape shape = ShapeFromModel(model, layout);
    ShapePoints body;
    for (const ShapeMarker& marker : shape.markers) {
      if (!marker.IsWhole()) continue;
      MarkerPoints& points = body[marker.marker_id];
      for (std::size_t i = 0; i < points.size(); ++i) points[i] = *marker.x_in_shape_m[i];
    }
    for (const DroppedMarker& marker : registration.dropped_markers) {
      map_.left_out[marker.marker_id] = marker.reason;
    }
    if (body.size() < kMinOnBody) return false;
    const ScaleAudit audit = AuditScale(shape, layout, &model, &summary.uncertainty);
    for (const MarkerScale& marker : audit.markers) {
      map_.sides[marker.marker_id] = {
          marker.side_m,
          marker.side_m * std::hypot(marker.sigma.value_or(0.0), audit.marker_spread)};
    }
    for (const auto& [marker_id, points] : body) map_.left_out.erase(marker_id);
    map_.bodies.push_back(std::move(body));
    return true;
  }

  std::optional<FormationEstimate> formation_;
  std::map<CameraId, Camera> cameras_;
  Layout layout_;
  RegistrationOptions registration_;
  MarkerAdjustmentOptions adjustment_;
  std::vector<DatabaseImage> images_;
  FrameCounts counts_;
  std::set<int> often_seen_;  // ids that may get a place
  ClipMap map_;
};

}  // namespace

ClipMap MapClip(const std::string& database_path, const Layout& layout, int num_threads) {
  const ColmapDatabase database(database_path, ColmapDatabase::Mode::kReadOnly);
  return Mapper(database, layout, num_threads).Map();
}

}  // namespace velamap
