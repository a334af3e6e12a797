// Chooses the frames that take part: the central frame and, in a video, frames around it (thesis
// 3.4.1).

#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reconstruct/geometry/frame_shape.h"
#include "reconstruct/thesis/frame_alignment.h"

namespace velamap {

// Number of markers that two frames have in common.
int NumSharedMarkers(const FrameShape& a, const FrameShape& b);

struct CentralFrame {
  int frame_idx = 0;
  std::string reason;
};

// The frame whose markers are seen most often in the other frames; the first of several that are
// equal.
CentralFrame ChooseCentralFrame(const std::vector<FrameShape>& frames);

struct FrameSearchOptions {
  int num_frames = 20;   // n
  int skip = 10;         // s
  int neighborhood = 5;  // m
  // Whether a window in which no frame aligns with the central one is aligned with the markers of
  // all frames found so far. The thesis does not.
  bool extends_shape = true;
};

// Adapts the parameters to a video with `num_frames_on_side` frames on the longer side of the
// central one: reduces the skip until n frames fit there, and the neighbourhood until the windows
// do not overlap.
FrameSearchOptions FitToVideo(const FrameSearchOptions& options, int num_frames_on_side);

// First and last frame number that the search can visit from a central frame: n skips, each of
// which may end m frames further. Limited to 0 and the largest int.
std::pair<int, int> ReachableFrames(int central_frame_number, const FrameSearchOptions& options);

// The frame that shares the most markers with the windows that the search visits around it.
CentralFrame ChooseCentralVideoFrame(const std::vector<FrameShape>& frames,
                                     const FrameSearchOptions& options);

struct SelectedFrame {
  int frame_idx = 0;
  FrameAlignment alignment;  // its shape frame is the central cam frame
};

// Thesis section 3.4.1: skips s frames from the central frame, takes the frame within m frames of
// there that has the most RANSAC inliers, and continues from it, n times on each side. Where no
// frame of a window aligns with the central frame, the window is aligned with the markers of all
// frames found so far if extends_shape; if that fails too, the window is skipped. `frames` are
// sorted by frame_number. The result does not contain the central frame.
std::vector<SelectedFrame> SearchFrames(const std::vector<FrameShape>& frames, int central_idx,
                                        const FrameSearchOptions& search, const Layout& layout,
                                        const FrameAlignmentOptions& alignment);

}  // namespace velamap
