#include "reconstruct/registration.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "importer/error.h"
#include "reconstruct/frame_selection.h"

namespace velamap {
namespace {

// Alternations of aligning every frame with the mean shape and averaging anew.
constexpr int kNumRefinements = 4;

// Images that reach this part of the best image's inliers join in the same round of growing.
constexpr double kJoinRatio = 0.8;

// The state of a registration while it grows.
struct Workspace {
  const Layout& layout;
  const RegistrationOptions& options;
  std::vector<FrameShape> frames;                         // in canonical order
  std::vector<const Camera*> cameras;                     // by frame_idx, as the next
  std::vector<std::optional<FrameAlignment>> alignments;  // with the shape
  ShapePoints shape;

  FrameAlignmentOptions AlignmentOptions() const {
    FrameAlignmentOptions alignment;
    alignment.ransac_max_error_m = options.ransac_max_error_m;
    alignment.min_num_inliers = options.min_num_inliers;
    alignment.random_seed = static_cast<std::uint32_t>(options.random_seed);
    return alignment;
  }
};

bool IsOutlier(const FrameAlignment& alignment, int marker_id) {
  return std::binary_search(alignment.outlier_ids.begin(), alignment.outlier_ids.end(), marker_id);
}

// Solutions of every marker in the shape frame, from all registered frames that agree with it.
std::map<int, std::vector<MarkerSolutions>> CollectSolutions(const Workspace& workspace) {
  std::map<int, std::vector<MarkerSolutions>> solutions_of;
  for (std::size_t idx = 0; idx < workspace.frames.size(); ++idx) {
    const auto& alignment = workspace.alignments[idx];
    if (!alignment) continue;
    for (const FrameMarker& marker : workspace.frames[idx].markers) {
      if (IsOutlier(*alignment, marker.marker_id)) continue;
      MarkerSolutions solutions;
      for (const MarkerPoints& x_in_cam : marker.x_in_cam) {
        solutions.push_back(Transform(alignment->shape_from_cam, x_in_cam));
      }
      solutions_of[marker.marker_id].push_back(std::move(solutions));
    }
  }
  return solutions_of;
}

void AverageShape(Workspace* workspace) {
  const ShapeAveragingOptions averaging{workspace->options.num_mean_iterations,
                                        workspace->options.mean_sigma_m};
  workspace->shape.clear();
  for (const auto& [marker_id, solutions] : CollectSolutions(*workspace)) {
    workspace->shape.emplace(marker_id, AverageMarker(solutions, averaging));
  }
}

int NumRegisteredFrames(const Workspace& workspace) {
  return static_cast<int>(std::count_if(workspace.alignments.begin(), workspace.alignments.end(),
                                        [](const auto& a) { return a.has_value(); }));
}

// Aligns every registered frame with the mean shape and averages again.
void RefineShape(Workspace* workspace) {
  for (int round = 0; round < kNumRefinements; ++round) {
    for (std::size_t idx = 0; idx < workspace->frames.size(); ++idx) {
      auto& alignment = workspace->alignments[idx];
      if (!alignment) continue;
      alignment = AlignFrame(workspace->frames[idx], workspace->shape, workspace->layout,
                             workspace->AlignmentOptions());
    }
    AverageShape(workspace);
  }
}

void StartAtCentralFrame(int central_idx, Workspace* workspace) {
  workspace->alignments.assign(workspace->frames.size(), std::nullopt);
  workspace->alignments[static_cast<std::size_t>(central_idx)] = FrameAlignment{};
  AverageShape(workspace);
}

void GrowFromCentralFrame(int central_idx, Workspace* workspace) {
  StartAtCentralFrame(central_idx, workspace);
  while (true) {
    std::map<std::size_t, FrameAlignment> candidates;
    std::size_t most_inliers = 0;
    for (std::size_t idx = 0; idx < workspace->frames.size(); ++idx) {
      if (workspace->alignments[idx]) continue;
      auto alignment = AlignFrame(workspace->frames[idx], workspace->shape, workspace->layout,
                                  workspace->AlignmentOptions());
      if (!alignment) continue;
      most_inliers = std::max(most_inliers, alignment->inlier_ids.size());
      candidates.emplace(idx, std::move(*alignment));
    }
    if (candidates.empty()) return;
    for (auto& [idx, alignment] : candidates) {
      if (static_cast<double>(alignment.inlier_ids.size()) >=
          kJoinRatio * static_cast<double>(most_inliers)) {
        workspace->alignments[idx] = std::move(alignment);
      }
    }
    AverageShape(workspace);
  }
}

void SearchInTimeOrder(int central_idx, const FrameSearchOptions& search, Workspace* workspace) {
  StartAtCentralFrame(central_idx, workspace);
  for (SelectedFrame& selected : SearchFrames(workspace->frames, central_idx, search,
                                              workspace->layout, workspace->AlignmentOptions())) {
    workspace->alignments[static_cast<std::size_t>(selected.frame_idx)] =
        std::move(selected.alignment);
  }
  AverageShape(workspace);
}

// Whether a marker's place in the mean shape projects to within one marker side of where the frame
// sees it: the thesis's 100 mm for a marker of 100 mm, but in the image, where the poor depth of a
// single marker's pose plays no part. What is wrong by less is the bundle adjustment's to find.
bool FitsInImage(const Camera& camera, const Rigid3& cam_from_shape, const FrameMarker& marker,
                 const MarkerPoints& x_in_shape) {
  const auto& corners_px = marker.corners_in_image_px;
  double squared_errors = 0.0, squared_sides = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const auto projected = ImageFromCam(camera, cam_from_shape * x_in_shape[i + 1]);
    if (!projected) return false;
    squared_errors += (*projected - corners_px[i]).squaredNorm();
    squared_sides += (corners_px[(i + 1) % kNumCorners] - corners_px[i]).squaredNorm();
  }
  return squared_errors <= squared_sides;
}

RegisteredFrame PlaceFrame(const Workspace& workspace, std::size_t idx) {
  const FrameShape& frame = workspace.frames[idx];
  RegisteredFrame registered{frame.image_id, frame.image_name, {}, {}, {}, 0.0, ""};
  const auto& alignment = workspace.alignments[idx];
  if (!alignment) return registered;
  registered.cam_from_shape = Inverse(alignment->shape_from_cam);
  registered.rms_error_m = alignment->rms_error_m;
  for (const FrameMarker& marker : frame.markers) {
    const auto place = workspace.shape.find(marker.marker_id);
    if (place == workspace.shape.end()) continue;
    const bool fits = FitsInImage(*workspace.cameras[idx], *registered.cam_from_shape, marker,
                                  place->second);
    (fits ? registered.marker_ids : registered.outlier_ids).push_back(marker.marker_id);
  }
  return registered;
}

// Removes markers that too few registered frames see (thesis: |Q_k| < beta) from shape and frames.
void DropRareMarkers(int min_num_frames, Registration* registration) {
  std::map<int, int> num_frames_of;
  for (const auto& [marker_id, points] : registration->shape) num_frames_of[marker_id] = 0;
  for (const RegisteredFrame& frame : registration->frames) {
    for (const int marker_id : frame.marker_ids) ++num_frames_of[marker_id];
  }
  for (const auto& [marker_id, num_frames] : num_frames_of) {
    if (num_frames >= min_num_frames) continue;
    registration->dropped_markers.push_back(
        {marker_id, num_frames,
         "seen in " + std::to_string(num_frames) + " registered frames, " +
             std::to_string(min_num_frames) + " are needed"});
    registration->shape.erase(marker_id);
  }
  for (RegisteredFrame& frame : registration->frames) {
    auto& ids = frame.marker_ids;
    ids.erase(std::remove_if(ids.begin(), ids.end(),
                             [registration](int id) { return !registration->shape.count(id); }),
              ids.end());
  }
}

// Order by frame number or name, so that neither row order nor ids decide anything.
std::vector<const DatabaseImage*> CanonicalOrder(const std::vector<DatabaseImage>& images) {
  std::vector<const DatabaseImage*> ordered;
  for (const DatabaseImage& image : images) {
    if (!image.detections.markers.empty()) ordered.push_back(&image);
  }
  std::sort(ordered.begin(), ordered.end(), [](const DatabaseImage* a, const DatabaseImage* b) {
    const FrameDetections &da = a->detections, &db = b->detections;
    return std::make_pair(da.frame_number.value_or(-1), da.image_name) <
           std::make_pair(db.frame_number.value_or(-1), db.image_name);
  });
  return ordered;
}

bool UseTimeOrder(const std::vector<FrameShape>& frames, FrameOrder order) {
  const bool all_numbered = std::all_of(
      frames.begin(), frames.end(), [](const FrameShape& f) { return f.frame_number.has_value(); });
  if (order == FrameOrder::kTime && !all_numbered) {
    throw InputError(
        "--Registration.frame_order time: the database has images without frame numbers; use auto "
        "or unordered");
  }
  return order == FrameOrder::kTime || (order == FrameOrder::kAuto && all_numbered);
}

int FindCentralFrame(const std::vector<FrameShape>& frames, const std::string& name_or_number) {
  for (std::size_t idx = 0; idx < frames.size(); ++idx) {
    const FrameShape& frame = frames[idx];
    if (frame.image_name == name_or_number ||
        (frame.frame_number && std::to_string(*frame.frame_number) == name_or_number)) {
      return static_cast<int>(idx);
    }
  }
  throw InputError("--Registration.central_frame " + name_or_number +
                   ": no image of that name or frame number holds markers; leave the option out to "
                   "let the best one be chosen");
}

std::string ReasonLeftOut(const Workspace& workspace, const FrameShape& frame, bool time_order) {
  int num_shared = 0;
  for (const FrameMarker& marker : frame.markers) {
    num_shared += static_cast<int>(workspace.shape.count(marker.marker_id));
  }
  if (num_shared < workspace.options.min_num_inliers) {
    return "shares " + std::to_string(num_shared) + " of its " +
           std::to_string(frame.markers.size()) + " markers with the registered images, " +
           std::to_string(workspace.options.min_num_inliers) + " are needed";
  }
  if (time_order) return "not selected by the search around the central frame";
  return "its " + std::to_string(num_shared) +
         " shared markers do not agree on a position of the camera";
}

// Moves everything so that the central image's camera is the origin again after averaging.
void ReturnToCentralFrame(int central_idx, Workspace* workspace) {
  const Rigid3 central_from_shape =
      Inverse(workspace->alignments[static_cast<std::size_t>(central_idx)]->shape_from_cam);
  for (auto& alignment : workspace->alignments) {
    if (alignment) alignment->shape_from_cam = central_from_shape * alignment->shape_from_cam;
  }
  for (auto& [marker_id, points] : workspace->shape) points = Transform(central_from_shape, points);
}

}  // namespace

void RegistrationOptions::Check() const {
  const auto require = [](bool ok, const std::string& option, const std::string& expected) {
    if (!ok) throw InputError("--Registration." + option + ": expected " + expected);
  };
  require(num_frames >= 1, "num_frames", "at least 1");
  require(skip >= 1, "skip", "at least 1");
  require(neighborhood >= 0, "neighborhood", "0 or more");
  require(ransac_max_error_m >= 0, "ransac_max_error", "0 (the marker's side) or a distance in m");
  require(min_num_inliers >= 2, "min_num_inliers", "at least 2");
  require(frequency_threshold >= 0 && frequency_threshold <= 1, "frequency_threshold",
          "a fraction between 0 and 1");
  require(min_num_frames >= 2, "min_num_frames", "at least 2");
  require(num_mean_iterations >= 0, "num_mean_iterations", "0 or more");
  require(mean_sigma_m > 0, "mean_sigma", "a positive distance in m");
}

int Registration::NumRegistered() const {
  return static_cast<int>(std::count_if(frames.begin(), frames.end(), [](const auto& frame) {
    return frame.cam_from_shape.has_value();
  }));
}

Registration RegisterFrames(const std::vector<DatabaseImage>& images,
                            const std::map<CameraId, Camera>& cameras, const Layout& layout,
                            const RegistrationOptions& options) {
  options.Check();
  Workspace workspace{layout, options, {}, {}, {}, {}};
  for (const DatabaseImage* image : CanonicalOrder(images)) {
    const Camera& camera = cameras.at(image->camera_id);
    workspace.frames.push_back(EstimateFrameShape(*image, camera, layout));
    workspace.cameras.push_back(&camera);
  }
  if (workspace.frames.size() < 2) {
    throw DataError("a shape needs at least two images with markers, the database has " +
                    std::to_string(workspace.frames.size()) +
                    "; take pictures from several positions");
  }

  Registration registration;
  const bool time_order = UseTimeOrder(workspace.frames, options.frame_order);
  FrameSearchOptions search{options.num_frames, options.skip, options.neighborhood};
  if (time_order) {
    const int num_video_frames =
        *workspace.frames.back().frame_number - *workspace.frames.front().frame_number + 1;
    search = FitToVideo(search, num_video_frames);
    if (search.skip != options.skip) {
      registration.notes.push_back("the video has " + std::to_string(num_video_frames) +
                                   " frames with markers in reach: skip " +
                                   std::to_string(search.skip) + " and neighborhood " +
                                   std::to_string(search.neighborhood) + " are used");
    }
  }
  CentralFrame central;
  if (!options.central_frame.empty()) {
    central = {FindCentralFrame(workspace.frames, options.central_frame), "named by option"};
  } else {
    central = time_order ? ChooseCentralVideoFrame(workspace.frames, search)
                         : ChooseCentralFrame(workspace.frames);
  }

  if (time_order) {
    SearchInTimeOrder(central.frame_idx, search, &workspace);
  } else {
    GrowFromCentralFrame(central.frame_idx, &workspace);
  }
  const std::size_t central_idx = static_cast<std::size_t>(central.frame_idx);
  registration.central_image_id = workspace.frames[central_idx].image_id;
  registration.central_image_name = workspace.frames[central_idx].image_name;
  registration.central_reason = central.reason;
  RefineShape(&workspace);
  if (!workspace.alignments[central_idx] || NumRegisteredFrames(workspace) < 2) {
    throw DataError("no image shares enough markers with the central image " +
                    registration.central_image_name + ": at least " +
                    std::to_string(options.min_num_inliers) +
                    " markers must be seen together in two images");
  }
  ReturnToCentralFrame(central.frame_idx, &workspace);
  for (std::size_t idx = 0; idx < workspace.frames.size(); ++idx) {
    registration.frames.push_back(PlaceFrame(workspace, idx));
    if (!workspace.alignments[idx]) {
      registration.frames.back().reason = ReasonLeftOut(workspace, workspace.frames[idx], time_order);
    }
  }
  registration.shape = std::move(workspace.shape);
  const int by_frequency =
      time_order ? static_cast<int>(std::ceil(options.frequency_threshold *
                                              registration.NumRegistered()))
                 : 0;
  DropRareMarkers(std::max(options.min_num_frames, by_frequency), &registration);
  return registration;
}

}  // namespace velamap
