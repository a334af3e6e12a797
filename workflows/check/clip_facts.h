// The facts about a clip that a few of its frames show.

#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/base/statistics.h"
#include "importer/camera/calibration_writer.h"
#include "reconstruct/camera/camera_steadiness.h"
#include "reconstruct/model/calibration_evidence.h"

namespace velamap {

// A part of a video, from a frame that was looked at to another one (clip_parts.h).
struct ClipPart {
  double begin_s = 0.0, end_s = 0.0;
  int first_frame = 0, last_frame = 0;
  std::string lacks{};  // why it does not suffice for a reconstruction; empty if it does
  int num_markers = 0;  // that at least two of its frames show
  std::optional<double> parallax_deg{};  // as in ClipPrecision; nothing without a precision
};

// A reconstruction from these frames alone.
struct ClipPrecision {
  int num_images = 0;
  int num_markers = 0;
  double marker_sigma_mm = 0.0;  // median over the markers' centres, with the scale
  double scale_sigma = 0.0;      // fraction
  double parallax_deg = 0.0;     // largest angle between two views of the middle of the markers
  SteadinessVerdict steadiness;  // of the camera
  std::vector<std::string> warnings;
  std::vector<std::string> markers_left_out;  // id and reason of those that contradict the layout
  CalibrationEvidence calibration;
  std::vector<EstimatedCamera> found_cameras;  // without a calibration
  // By image name: the direction from the middle of the markers to the camera.
  std::map<std::string, Eigen::Vector3d> directions{};
  std::set<std::string> contradicting_images{};  // names of those in which much does not fit
};

struct ClipFacts {
  int num_frames = 0;  // of the clip; 0 if it does not say
  int num_frames_read = 0;
  int num_frames_with_few_markers = 0;  // fewer than four
  int num_frames_damaged = 0;           // that should have been read, but are damaged in the file
  bool is_video = false;
  bool shows_one_picture = false;  // in all frames with markers, if there are at least two of them
  int width_px = 0, height_px = 0;

  std::string dictionary;
  bool is_inverted = false;
  // Markers found with the dictionary, if it was found by trial, and with the next best one.
  std::optional<int> num_markers_found, num_markers_of_second;
  std::string second_dictionary;

  std::string no_markers_because;       // the importer's reason why there are none
  std::map<int, int> num_frames_of_id;  // of markers that the layout names, or of all
  std::vector<int> ids_never_seen;      // of the layout
  // Those of them that have seen markers on both sides on a line of the layout.
  std::vector<int> ids_unseen_between_seen;
  std::vector<int> ids_not_in_layout;  // seen too often to be misread
  std::vector<int> ids_read_rarely;    // probably misread: not in the layout, or without one any
  // Found only in mirrored frames, if these show more markers than the frames themselves.
  std::vector<int> ids_mirrored;
  bool has_layout = false;

  // Whether the clip shows no markers, or less than a quarter of the layout's.
  bool MissesMostMarkers() const {
    const std::size_t num_seen = num_frames_of_id.size();
    return num_seen == 0 || (has_layout && ids_never_seen.size() > 3 * num_seen);
  }

  Statistics side_px;
  // Medians over the markers; nothing if no side could be measured.
  std::optional<double> black, white;        // grey levels, 0 to 255
  std::optional<double> blur_px, motion_px;  // sigma of the blur; path during the exposure
  // The fraction of the measured markers that are overexposed or pale, and the ids for which most
  // of their pictures are.
  double poor_light_share = 0.0;
  std::vector<int> ids_in_poor_light;
  std::vector<ClipPart> parts;  // videos
  std::optional<ClipPrecision> precision;
  std::string no_precision_because;
  bool has_camera = false;

  // Whether no precision was measured although there are markers: it needs their sizes.
  bool LacksSizes() const {
    return !precision && no_precision_because.empty() && !num_frames_of_id.empty();
  }

  // With a proposed layout: markers that are there twice or badly printed, and where the layout is
  // wrong, one line each.
  std::vector<std::string> contradictions;
  std::string no_proposal_because;
};

}  // namespace velamap
