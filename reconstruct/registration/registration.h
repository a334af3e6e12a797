// The result of a registration by either method: poses of the frames and positions of the markers,
// from which the bundle adjustment starts.

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "importer/base/ids.h"
#include "importer/geometry/rigid3.h"
#include "reconstruct/geometry/frame_shape.h"

namespace velamap {

// Why a frame is not registered.
struct LeftOut {
  enum class Cause {
    kUnfit,       // it shares too little with the registered frames, or contradicts them
    kNotTried,    // it shows what frames next to it show
    kAddsLittle,  // it had been registered, but the others are precise enough without it
  };
  Cause cause = Cause::kUnfit;
  std::string reason;  // in words; empty for a frame that is registered

  bool IsNotNeeded() const { return cause != Cause::kUnfit; }
};

// A marker in a frame that does not fit its position in the shape.
struct OutlierMarker {
  int marker_id = 0;
  std::string reason;       // empty with kThesis
  bool is_dropped = false;  // from all frames
};

struct RegisteredFrame {
  ImageId image_id = 0;
  std::string image_name;
  std::optional<Rigid3> cam_from_shape;  // none: not registered
  LeftOut left_out;
  std::vector<int> marker_ids;          // inliers, ascending
  std::vector<OutlierMarker> outliers;  // by ascending marker_id
  // kGlobal: of the reprojection errors, as lengths at the distance of the markers. kThesis: of the
  // alignment with the mean shape.
  double rms_error_m = 0.0;
  // Number of the shape's markers that contradict the other frames: all that the frame shows if no
  // pose fits it, or the outliers if there are more than chance and false detections explain;
  // otherwise 0.
  int num_contradicting = 0;
};

struct DroppedMarker {
  int marker_id = 0;
  int num_frames = 0;
  std::string reason;
  // The images agree on its place, but the layout contradicts it.
  bool is_false = false;
  // Its side in units of its marker_length, divided by the median of all markers; set where the two
  // differ by far more than errors of print explain.
  std::optional<double> size_ratio{};
};

// The shape frame is the cam frame of the central image. Metres follow from the nominal marker
// sides (kGlobal: from their median).
struct Registration {
  ImageId central_image_id = 0;
  std::string central_image_name;
  std::string central_reason;           // why this frame is the central one
  std::vector<RegisteredFrame> frames;  // all images with markers, in canonical order
  ShapePoints shape;                    // kThesis: means over the frames
  std::vector<DroppedMarker> dropped_markers;
  // Parameters that were adapted to the data, and doubts about the result, one line each.
  std::vector<std::string> notes;

  int NumRegistered() const;
};

// Throws DataError if fewer than `needed` images have markers.
void CheckEnoughImages(std::size_t num_images, std::size_t needed);

// Sets the reason and `num_contradicting` of a frame that was not registered. It shares
// `num_shared` of its `num_markers` markers with the registered images; `needed` is the smallest
// number with which a frame can be registered.
void ExplainWhyNotRegistered(int num_shared, int num_markers, int needed, RegisteredFrame* frame);

// Sets `num_contradicting` of a registered frame: the outliers that are not dropped from all
// frames, if they are at least eight and all outliers are a quarter of the frame's markers.
void CountContradictions(RegisteredFrame* frame);

// Returns a warning, with the possible causes and a remedy, if at least a fifth of the frames show
// eight markers of the shape or more that contradict the other frames. Empty otherwise.
std::string CameraDoubt(const Registration& registration);

}  // namespace velamap
