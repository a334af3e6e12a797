// Which frames take part: the central frame and, in a video, the frames around it (thesis 3.4.1).

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

// The frame whose markers recur most in all others; ties go to the earlier frame.
CentralFrame ChooseCentralFrame(const std::vector<FrameShape>& frames);

struct FrameSearchOptions {
  int num_frames = 20;   // n
  int skip = 10;         // s
  int neighborhood = 5;  // m
};

// The parameters that fit a video with `num_frames_on_side` frames on the longer side of the
// central one: the skip shrinks so that n frames find room there, the neighbourhood so that windows
// do not overlap.
FrameSearchOptions FitToVideo(const FrameSearchOptions& options, int num_frames_on_side);

// First and last frame number that the search can visit from a central frame: n times a skip that
// ends up to m frames further.
std::pair<int, int> ReachableFrames(int central_frame_number, const FrameSearchOptions& options);

// The frame that shares most markers with the windows that the search will visit around it.
CentralFrame ChooseCentralVideoFrame(const std::vector<FrameShape>& frames,
                                     const FrameSearchOptions& options);

struct SelectedFrame {
  int frame_idx = 0;
  FrameAlignment alignment;  // its shape frame is the central cam frame
};

// Thesis section 3.4.1: from the central frame skip s frames, take the frame within m of there that
// has most RANSAC inliers, go on from it, n times on each side. Where the camera
// has moved so far that no frame of a window aligns with the central frame, the markers of the
// frames found so far take its place; a window in which that fails too is passed over. `frames`
// ascend by frame_number. The central frame itself is not in the result.
std::vector<SelectedFrame> SearchFrames(const std::vector<FrameShape>& frames, int central_idx,
                                        const FrameSearchOptions& search, const Layout& layout,
                                        const FrameAlignmentOptions& alignment);

}  // namespace velamap
