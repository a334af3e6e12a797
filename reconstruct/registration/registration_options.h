// Options of the registration, common to both methods or of one of them.

#pragma once

#include <string>

#include "importer/base/option.h"

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

// How closely to follow the thesis where its method can be improved.
enum class ThesisVariant {
  kRobust,  // both poses of a marker, a search that adapts to the video, shape refined in rounds
  kExact,   // thesis 3.3 to 3.5 to the letter: thesis/README.md lists the differences
};

// Thesis, sections 3.4 and 3.5, with its symbols.
struct ThesisRegistrationOptions {
  // n, frames on each side of the central one (time order). 0: the central frame alone, whose
  // single marker poses are then the shape (the detection that thesis 4.1 examines).
  int num_frames = 20;
  int skip = 10;                     // s, frames between selected ones (time order)
  int neighborhood = 5;              // m, frames on each side of the skip that compete (time order)
  double ransac_max_error_m = 0.0;   // 0: the marker's side (the thesis's 100 mm)
  double frequency_threshold = 0.3;  // beta, fraction of frames that see a marker (time order)
  int num_mean_iterations = 30;
  double mean_sigma_m = 0.6;
  ThesisVariant variant = ThesisVariant::kRobust;

  bool IsExact() const { return variant == ThesisVariant::kExact; }
};

struct GlobalRegistrationOptions {
  // Number of frames of a video that take part, chosen for the precision that they add to all
  // markers. All photographs take part.
  int max_num_frames = 80;
  int num_starts = 4;  // pairs of frames from which a map is grown before the best map is kept
};

struct RegistrationOptions {
  RegistrationMethod method = RegistrationMethod::kGlobal;
  FrameOrder frame_order = FrameOrder::kAuto;
  std::string central_frame;  // image name or frame number; empty: the best one is chosen
  int min_num_inliers = 2;    // minimum number of shared markers that agree to register a frame
  int min_num_frames = 2;     // minimum number of frames that see a marker
  // Whether the cameras are calibrated (possibly wrongly) rather than guessed.
  bool has_calibration = true;
  int random_seed = 0;
  int num_threads = 0;  // 0: one per core; never changes the result
  ThesisRegistrationOptions thesis;
  GlobalRegistrationOptions global;

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(ThesisRegistrationOptions* options);
OptionGroup DescribeOptions(GlobalRegistrationOptions* options);
OptionGroup DescribeOptions(RegistrationOptions* options);  // common ones and both methods'

}  // namespace velamap
