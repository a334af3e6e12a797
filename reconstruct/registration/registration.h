// The result of a registration, by either method: poses of frames and places of markers, the first
// guess of the surface.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "importer/base/ids.h"
#include "importer/geometry/rigid3.h"
#include "reconstruct/geometry/frame_shape.h"

namespace velamap {

struct RegisteredFrame {
  ImageId image_id = 0;
  std::string image_name;
  std::optional<Rigid3> cam_from_shape;      // none: left out, see `reason`
  std::vector<int> marker_ids;               // markers that stay in this frame, ascending
  std::vector<int> outlier_ids;              // markers that do not fit their place in the shape
  std::vector<std::string> outlier_reasons;  // kGlobal: by outlier_ids; empty with kThesis
  double rms_error_m = 0.0;                  // of the alignment with the mean shape
  std::string reason;                        // why it was left out, empty for a registered frame
};

struct DroppedMarker {
  int marker_id = 0;
  int num_frames = 0;
  std::string reason;
};

// The shape frame is the cam frame of the central image, m by the nominal marker side (kGlobal: by
// the median over the markers).
struct Registration {
  ImageId central_image_id = 0;
  std::string central_image_name;
  std::string central_reason;           // why this frame is the central one
  std::vector<RegisteredFrame> frames;  // all images with markers, in order
  ShapePoints shape;                    // mean points by marker id
  std::vector<DroppedMarker> dropped_markers;
  // Parameters that had to be fitted to the data, and doubts about the result, one a line.
  std::vector<std::string> notes;

  int NumRegistered() const;
};

}  // namespace velamap
