// Chooses the frames that take part: the central frame and, in a video, frames around it (thesis
// 3.4.1).

#pragma once

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

// Adapts the parameters to a video with `num_frames_on_side` frames on the longer side of the
// central one: reduces the skip until n frames fit there, and the neighbourhood until the windows
// do not overlap.
ThesisRegistrationOptions FitToVideo(const ThesisRegistrationOptions& options,
                                     int num_frames_on_side);

// First and last frame number that the search can visit from a central frame: n skips, each of
// which may end m frames further. Limited to 0 and the largest int.
std::pair<int, int> ReachableFrames(int central_frame_number,
                                    const ThesisRegistrationOptions& options);

// The frame that shares the most markers with the windows that the search visits around it.
CentralFrame ChooseCentralVideoFrame(const std::vector<FrameShape>& frames,
                                     const ThesisRegistrationOptions& options);

struct SelectedFrame {
  int frame_idx = 0;
  FrameAlignment alignment;  // its shape frame is the central cam frame
};

// Thesis section 3.4.1: skips s frames from the central frame, takes the frame within m frames of
// there that has the most RANSAC inliers, and continues from it, n times on each side. If no
// frame of a window aligns with the central frame, the window is skipped; ThesisVariant::kRobust
// first aligns it with the markers of all frames found so far. `frames` are sorted by frame_number.
// The result does not contain the central frame.
std::vector<SelectedFrame> SearchFrames(const std::vector<FrameShape>& frames, int central_idx,
                                        const Layout& layout, const RegistrationOptions& options);

}  // namespace velamap
