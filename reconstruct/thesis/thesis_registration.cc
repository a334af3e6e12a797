#include "reconstruct/thesis/thesis_registration.h"

#include <algorithm>
#include <cmath>

#include "importer/base/error.h"
#include "importer/geometry/alignment.h"
#include "reconstruct/registration/frame_order.h"
#include "reconstruct/thesis/frame_selection.h"
#include "reconstruct/thesis/registration_state.h"

namespace velamap {
namespace {

// Tells whether the marker's position in the mean shape projects to within one marker side of its
// detection. This is the thesis's limit (100 mm for markers of 100 mm), applied in the image, where
// the poor depth of single-marker poses does not matter. The bundle adjustment finds smaller
// errors.
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

RegisteredFrame PlaceFrame(const RegistrationState& state, std::size_t idx) {
  const FrameShape& frame = state.frames[idx];
  RegisteredFrame registered;
  registered.image_id = frame.image_id;
  registered.image_name = frame.image_name;
  const auto& alignment = state.alignments[idx];
  if (!alignment) return registered;
  registered.cam_from_shape = Inverse(alignment->shape_from_cam);
  registered.rms_error_m = alignment->rms_error_m;
  for (const FrameMarker& marker : frame.markers) {
    const auto place = state.shape.find(marker.marker_id);
    if (place == state.shape.end()) continue;
    const bool fits =
        state.options.thesis.IsExact()
            ? !IsOutlier(*alignment, marker.marker_id)  // RANSAC decides alone (3.4.1)
            : FitsInImage(*state.cameras[idx], *registered.cam_from_shape, marker, place->second);
    if (fits) {
      registered.marker_ids.push_back(marker.marker_id);
    } else {
      registered.outliers.push_back({marker.marker_id, ""});
    }
  }
  return registered;
}

// Removes markers that too few registered frames see (thesis: |Q_k| < beta).
void DropRareMarkers(int min_num_frames, Registration* registration) {
  std::map<int, int> num_frames_of;
  for (const auto& [marker_id, points] : registration->shape) num_frames_of[marker_id] = 0;
  for (const RegisteredFrame& frame : registration->frames) {
    for (const int marker_id : frame.marker_ids) ++num_frames_of[marker_id];
  }
  for (const auto& [marker_id, num_frames] : num_frames_of) {
    if (num_frames >= min_num_frames) continue;
    registration->dropped_markers.push_back({marker_id, num_frames,
                                             "seen in " + std::to_string(num_frames) +
                                                 " registered frames; " +
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

// Thesis, equation 3.5: aligns the centres of the frame's markers with the mean shape. A frame with
// fewer than three markers, or with markers on one line, keeps the pose of its registration.
void PoseByCenters(const FrameShape& frame, const ShapePoints& shape, RegisteredFrame* registered) {
  std::vector<Eigen::Vector3d> x_in_shape, x_in_cam;
  for (const int marker_id : registered->marker_ids) {
    x_in_shape.push_back(shape.at(marker_id)[0]);
    x_in_cam.push_back(FindMarkerById(frame.markers, marker_id)->x_in_cam.front()[0]);
  }
  if (x_in_shape.size() < 3 || !HasSpread(x_in_shape)) return;
  registered->cam_from_shape = EstimateRigid3(x_in_shape, x_in_cam);
}

// Reduces the skip if the video is too short for the search, and adds a note.
void FitSearch(const std::optional<CentralFrame>& central, RegistrationState* state,
               std::vector<std::string>* notes) {
  const std::vector<FrameShape>& frames = state->frames;
  ThesisRegistrationOptions& search = state->options.thesis;
  const int first = *frames.front().frame_number, last = *frames.back().frame_number;
  int num_frames_on_side = (last - first) / 2;
  if (central) {
    const int number = *frames[static_cast<std::size_t>(central->frame_idx)].frame_number;
    num_frames_on_side = std::max(number - first, last - number);
  }
  const ThesisRegistrationOptions fitted = FitToVideo(search, num_frames_on_side);
  if (fitted.skip != search.skip) {
    notes->push_back("the video is too short for " + std::to_string(search.num_frames) +
                     " skips of " + std::to_string(search.skip) + " frames: skip " +
                     std::to_string(fitted.skip) + " and neighborhood " +
                     std::to_string(fitted.neighborhood) + " are used");
  }
  search = fitted;
}

void ExplainWhyNotRegistered(const RegistrationState& state, const FrameShape& shape,
                             bool time_order, RegisteredFrame* frame) {
  int num_shared = 0;
  for (const FrameMarker& marker : shape.markers) {
    num_shared += static_cast<int>(state.shape.count(marker.marker_id));
  }
  const int needed = state.options.min_num_inliers;
  if (num_shared >= needed && time_order) {
    frame->left_out.reason = "not selected by the search around the central frame";
  } else {
    ExplainWhyNotRegistered(num_shared, static_cast<int>(shape.markers.size()), needed, frame);
  }
}

// Moves the shape frame back to the central image's camera, from which averaging has shifted it.
void ReturnToCentralFrame(int central_idx, RegistrationState* state) {
  const Rigid3 central_from_shape =
      Inverse(state->alignments[static_cast<std::size_t>(central_idx)]->shape_from_cam);
  for (auto& alignment : state->alignments) {
    if (alignment) alignment->shape_from_cam = central_from_shape * alignment->shape_from_cam;
  }
  for (auto& [marker_id, points] : state->shape) points = Transform(central_from_shape, points);
}

// Chooses the central frame unless the options name it, and registers the others around it.
CentralFrame RegisterFromCentralFrame(const std::vector<const DatabaseImage*>& ordered,
                                      bool time_order, RegistrationState* state,
                                      std::vector<std::string>* notes) {
  const RegistrationOptions& options = state->options;
  std::optional<CentralFrame> central;
  if (!options.central_frame.empty()) {
    central = CentralFrame{FindCentralFrame(ordered, options), "named by option"};
  }
  if (!time_order) {
    if (!central) central = ChooseCentralFrame(state->frames);
    GrowFromCentralFrame(central->frame_idx, state);
    return *central;
  }
  if (options.thesis.num_frames > 0 && !options.thesis.IsExact()) {
    FitSearch(central, state, notes);
  }
  if (!central) central = ChooseCentralVideoFrame(state->frames, options.thesis);
  SearchInTimeOrder(central->frame_idx, state, notes);
  return *central;
}

}  // namespace

Registration RegisterAroundCentralFrame(const PosedImages& posed, const Layout& layout,
                                        const RegistrationOptions& options) {
  options.Check();
  VELAMAP_CHECK(options.method == RegistrationMethod::kThesis);
  RegistrationState state{layout, options, posed.frames, posed.cameras, {}, {}};
  const std::vector<const DatabaseImage*>& ordered = posed.images;
  const bool time_order = UseTimeOrder(ordered, options.frame_order);
  const int min_num_registered = time_order && options.thesis.num_frames == 0 ? 1 : 2;
  CheckEnoughImages(state.frames.size(), static_cast<std::size_t>(min_num_registered));

  Registration registration;
  const CentralFrame central =
      RegisterFromCentralFrame(ordered, time_order, &state, &registration.notes);
  const std::size_t central_idx = static_cast<std::size_t>(central.frame_idx);
  registration.central_image_id = state.frames[central_idx].image_id;
  registration.central_image_name = state.frames[central_idx].image_name;
  registration.central_reason = central.reason;
  if (!options.thesis.IsExact()) RefineShape(&state);
  if (!state.alignments[central_idx] || state.NumRegistered() < min_num_registered) {
    throw DataError("no frame shares enough markers with the central frame " +
                    registration.central_image_name + ": at least " +
                    std::to_string(options.min_num_inliers) +
                    " markers must be seen together in two images");
  }
  ReturnToCentralFrame(central.frame_idx, &state);
  for (std::size_t idx = 0; idx < state.frames.size(); ++idx) {
    registration.frames.push_back(PlaceFrame(state, idx));
    if (!state.alignments[idx]) {
      ExplainWhyNotRegistered(state, state.frames[idx], time_order, &registration.frames.back());
    }
  }
  registration.shape = std::move(state.shape);
  const int by_frequency =
      time_order ? static_cast<int>(
                       std::ceil(options.thesis.frequency_threshold * registration.NumRegistered()))
                 : 0;
  const int min_num_frames = std::min(options.min_num_frames, registration.NumRegistered());
  DropRareMarkers(std::max(min_num_frames, by_frequency), &registration);
  if (options.thesis.IsExact()) {
    for (std::size_t idx = 0; idx < state.frames.size(); ++idx) {
      PoseByCenters(state.frames[idx], registration.shape, &registration.frames[idx]);
    }
  }
  return registration;
}

}  // namespace velamap
