// Registers frames and places markers: the first guess of the surface. Two methods do it; the
// global one is in reconstruct/global/global_registration.h.
//
// The thesis's (3.4 and 3.5) registers frames to a central frame and averages their markers. A
// video is searched in time order. Photographs have no time order: there the central frame is the
// one that has most markers in common with the others, and images are added one after another to
// the growing mean shape, so that those that share nothing with the central frame are reached
// through others.

#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "importer/camera/camera.h"
#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/frame_shape.h"
#include "reconstruct/thesis/frame_alignment.h"
#include "reconstruct/thesis/posed_images.h"
#include "reconstruct/thesis/shape_averaging.h"

namespace velamap {

enum class RegistrationMethod {
  kThesis,  // rigid alignment of single-marker poses around one central frame
  kGlobal,  // resection of all frames against a map that grows from several starts
};

enum class FrameOrder {
  kAuto,       // time where all images carry frame numbers, else none
  kTime,       // thesis search around the central frame
  kUnordered,  // growing from the central frame
};

struct RegistrationOptions {
  RegistrationMethod method = RegistrationMethod::kGlobal;
  FrameOrder frame_order = FrameOrder::kAuto;
  std::string central_frame;  // image name or frame number; empty: the best one is chosen
  // n, frames on each side of the central one (time order). 0: the central frame alone, whose
  // single marker poses are then the shape (the detection that thesis 4.1 examines).
  int num_frames = 20;
  int skip = 10;                    // s, frames between selected ones (time order)
  int neighborhood = 5;             // m, frames on each side of the skip that compete (time order)
  double ransac_max_error_m = 0.0;  // 0: the marker's side (the thesis's 100 mm)
  int min_num_inliers = 2;          // fewest shared markers that agree for a frame to be registered
  double frequency_threshold = 0.3;  // beta, part of the selected frames that see a marker (time)
  int min_num_frames = 2;            // fewest frames that see a marker
  int num_mean_iterations = 30;
  double mean_sigma_m = 0.6;
  // kGlobal: frames of a video that take part; chosen for what they add to the precision of all
  // markers. Photographs take part all.
  int max_num_frames = 80;
  // kGlobal: pairs of frames from which a map is grown before the best map is kept.
  int num_starts = 4;
  int random_seed = 0;

  void Check() const;  // throws InputError that names the option
};

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

// Throws DataError with the reason when there are fewer than two images with markers, or none can
// be registered with the central one; InputError for an unknown central frame. The order of
// `images` and their ids do not matter.
Registration RegisterFrames(const std::vector<DatabaseImage>& images,
                            const std::map<CameraId, Camera>& cameras, const Layout& layout,
                            const RegistrationOptions& options);

// The same by the thesis's method, of images that are posed already: for several central frames of
// one clip.
Registration RegisterPosedImages(const PosedImages& posed, const Layout& layout,
                                 const RegistrationOptions& options);

}  // namespace velamap
