#include "reconstruct/global/global_registration_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace velamap {
namespace {

// Transforms the solution to the camera of the central frame, and to metres by the median marker.
void SetFrameAndScale(int central_idx, GlobalRegistration* global) {
  MapSolution& solution = global->solution;
  const double scale = 1 / global->MedianMarkerScale();
  const Rigid3 central = *solution.Pose(central_idx);
  for (auto& pose : solution.cam_from_shape) {
    if (!pose) continue;
    *pose = *pose * Inverse(central);
    pose->translation *= scale;
  }
  for (auto& places : solution.shape_from_marker) {
    for (Sim3& place : places) {
      place = central * place;
      place.translation *= scale;
      place.scale *= scale;
    }
  }
}

void ExplainMissingFrame(const GlobalRegistration& global, int frame_idx, RegisteredFrame* frame) {
  if (frame->left_out.reason.empty()) {
    ExplainWhyNotRegistered(
        NumKnown(global.problem, global.solution, frame_idx),
        static_cast<int>(global.problem.Frame(frame_idx).observation_idxs.size()),
        global.options.min_num_inliers, frame);
  }
  const auto contradicting = global.num_contradicting_of_frame.find(frame_idx);
  if (contradicting != global.num_contradicting_of_frame.end()) {
    frame->num_contradicting = contradicting->second;
  }
}

// Sorts the markers that a registered frame shows into those that determine its pose and outliers.
void AddFrameMarkers(const GlobalRegistration& global, int frame_idx, RegisteredFrame* frame) {
  const MapFrame& observed = global.problem.Frame(frame_idx);
  double sum = 0.0;
  for (const int idx : observed.observation_idxs) {
    const MapObservation& observation = global.problem.Observation(idx);
    const auto& places = global.solution.Places(observation.marker_idx);
    const int marker_id = global.problem.Marker(observation.marker_idx).marker_id;
    if (places.empty()) {
      const auto dropped = global.dropped_markers.find(observation.marker_idx);
      if (dropped == global.dropped_markers.end()) continue;
      frame->outliers.push_back(
          {marker_id, "left out of all images: " + dropped->second.reason, true});
      continue;
    }
    if (!global.solution.IsInlier(idx)) {
      frame->outliers.push_back(
          {marker_id, OutlierReason(global.problem, global.solution, global.noise, observation)});
      continue;
    }
    frame->marker_ids.push_back(marker_id);
    const double m_per_px = (*frame->cam_from_shape * places.front().translation).z() /
                            MeanFocalLength(*observed.camera);
    const double error_px = ReprojectionError(global.problem, global.solution, observation);
    sum += std::pow(error_px * m_per_px, 2);
  }
  if (!frame->marker_ids.empty()) {
    frame->rms_error_m = std::sqrt(sum / static_cast<double>(frame->marker_ids.size()));
  }
}

void DescribeFrame(const GlobalRegistration& global, int frame_idx, RegisteredFrame* frame) {
  const auto& pose = global.solution.Pose(frame_idx);
  if (!pose) {
    ExplainMissingFrame(global, frame_idx, frame);
    return;
  }
  frame->cam_from_shape = *pose;
  AddFrameMarkers(global, frame_idx, frame);
  CountContradictions(frame);
}

void AddMarkers(const GlobalRegistration& global, Registration* registration) {
  for (std::size_t idx = 0; idx < global.problem.markers.size(); ++idx) {
    const MapMarker& marker = global.problem.markers[idx];
    const auto& places = global.solution.shape_from_marker[idx];
    const auto dropped = global.dropped_markers.find(static_cast<int>(idx));
    if (!places.empty()) {
      MarkerPoints points;
      points[0] = places.front().translation;
      const auto corners = CornersInShape(marker, places.front());
      std::copy(corners.begin(), corners.end(), points.begin() + 1);
      registration->shape.emplace(marker.marker_id, points);
    } else if (dropped != global.dropped_markers.end()) {
      registration->dropped_markers.push_back(dropped->second);
    } else {
      const auto num_seen = std::count_if(
          marker.observation_idxs.begin(), marker.observation_idxs.end(), [&global](int i) {
            return global.solution.Pose(global.problem.Observation(i).frame_idx).has_value();
          });
      registration->dropped_markers.push_back(
          {marker.marker_id, static_cast<int>(num_seen),
           num_seen == 0
               ? "no registered frame shows it"
               : fmt::format("seen in {} registered frames, no two of which agree on its place",
                             num_seen)});
    }
  }
}

}  // namespace

Registration MakeRegistration(int central_idx, GlobalRegistration global) {
  SetFrameAndScale(central_idx, &global);
  Registration registration;
  const DatabaseImage& central = *global.problem.Frame(central_idx).image;
  registration.central_image_id = central.image_id;
  registration.central_image_name = central.detections.image_name;
  registration.central_reason = global.central_image_idx >= 0
                                    ? "named by option"
                                    : "its markers are seen most often in the other images";
  std::vector<int> frame_idx_of_image(global.images.size(), -1);
  for (std::size_t idx = 0; idx < global.image_idx_of_frame.size(); ++idx) {
    frame_idx_of_image[static_cast<std::size_t>(global.image_idx_of_frame[idx])] =
        static_cast<int>(idx);
  }
  for (std::size_t idx = 0; idx < global.images.size(); ++idx) {
    RegisteredFrame frame;
    frame.image_id = global.images[idx]->image_id;
    frame.image_name = global.images[idx]->detections.image_name;
    frame.left_out = global.left_out_of_image[idx];
    if (frame_idx_of_image[idx] >= 0) DescribeFrame(global, frame_idx_of_image[idx], &frame);
    registration.frames.push_back(std::move(frame));
  }
  AddMarkers(global, &registration);
  registration.notes = global.notes;
  return registration;
}

}  // namespace velamap
