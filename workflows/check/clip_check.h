// Checks a clip in a few seconds, before any reconstruction.

#pragma once

#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "importer/camera/camera.h"
#include "importer/detect/detection_options.h"
#include "importer/layout/layout.h"
#include "importer/video/video_options.h"
#include "workflows/check/clip_facts.h"
#include "workflows/proposal/layout_proposal.h"

namespace velamap {

struct ClipCheckOptions {
  std::string image_path;  // folder of images, or a video file
  // If set, a reconstruction finds the precision; otherwise the dictionary is found by trial.
  std::optional<Layout> layout;
  std::optional<Camera> camera;  // nothing: it is found from the markers if there is a layout
  std::string camera_path;       // for messages only
  // Find where the markers are by a reconstruction, with or without a camera, and propose a layout.
  bool proposes_layout = false;
  ArucoDetectionOptions detection;
  VideoOptions video;
  int num_frames = 40;  // to look at, of a video, at most
  int num_threads = 0;  // 0: one per core
};

struct ClipCheck {
  ClipFacts facts;
  // The frame with most markers, with their outlines and ids drawn on it; BGR. Markers that the
  // layout does not name are red.
  cv::Mat marked_frame;
  std::string marked_frame_name;
  // If ClipCheckOptions::proposes_layout is set and the frames give one.
  std::optional<LayoutProposal> proposal;
};

// Throws InputError as OpenFrameSource() and MakeFrameDetector() do.
ClipCheck CheckClip(const ClipCheckOptions& options);

}  // namespace velamap
