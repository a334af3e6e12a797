// Markers that were printed mirrored or with black and white exchanged. An ordinary search misses
// them or takes them for other markers.

#pragma once

#include <map>
#include <string>
#include <vector>

#include "importer/detect/detection.h"
#include "importer/detect/detection_options.h"
#include "importer/layout/layout.h"
#include "importer/video/frame_source.h"

namespace velamap {

struct PrintFaults {
  // Number of frames (at least two) that show the marker with this fault, by marker id.
  std::map<int, int> mirrored, inverted;
};

// Searches the mirrored and the inverted `frames` where none of `found`, which is by the frames'
// image names, is a marker of the layout. Only ids of the layout count where it names any.
PrintFaults FindPrintFaults(const std::vector<Frame>& frames,
                            const std::map<std::string, const FrameDetections*>& found,
                            const Layout& layout, const ArucoDetectionOptions& detection);

// One line for each faulty marker, or one for all if there are four or more of them and at least as
// many as the `num_markers` markers that were found right. `num_frames` frames were searched.
std::vector<std::string> DescribeFaults(const PrintFaults& faults, int num_markers, int num_frames);

}  // namespace velamap
