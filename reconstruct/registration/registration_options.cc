#include "reconstruct/registration/registration_options.h"

namespace velamap {
namespace {

const Choices<RegistrationMethod> kMethods = {{RegistrationMethod::kThesis, "thesis"},
                                              {RegistrationMethod::kGlobal, "global"}};

const Choices<FrameOrder> kFrameOrders = {{FrameOrder::kAuto, "auto"},
                                          {FrameOrder::kTime, "time"},
                                          {FrameOrder::kUnordered, "unordered"}};

const Choices<ThesisVariant> kVariants = {{ThesisVariant::kRobust, "robust"},
                                          {ThesisVariant::kExact, "exact"}};

void Append(const OptionGroup& group, OptionGroup* all) {
  all->options.insert(all->options.end(), group.options.begin(), group.options.end());
}

}  // namespace

OptionGroup DescribeOptions(GlobalRegistrationOptions* options) {
  return {"Global registration",
          {{"Registration.max_num_frames", &options->max_num_frames, "frames",
            "maximum number of frames of a video that take part (global)", AtLeast(3)},
           {"Registration.num_starts", &options->num_starts, "count",
            "maximum number of pairs of frames from which a map is grown (global)", AtLeast(1)}}};
}

OptionGroup DescribeOptions(ThesisRegistrationOptions* options) {
  return {"Registration of the thesis",
          {{"Registration.num_frames", &options->num_frames, "frames",
            "frames on each side of the central one; 0: none (thesis, time order)", AtLeast(0)},
           {"Registration.skip", &options->skip, "frames",
            "frames from one selected frame to the next (thesis, time order)", AtLeast(1)},
           {"Registration.neighborhood", &options->neighborhood, "frames",
            "frames on each side of a selected one that compete with it (thesis, time order)",
            AtLeast(0)},
           {"Registration.ransac_max_error", &options->ransac_max_error_m, "m",
            "a marker farther than this from its place is an outlier; 0: the marker's side "
            "(thesis)",
            AtLeast(0)},
           {"Registration.frequency_threshold", &options->frequency_threshold, "fraction",
            "fraction of the registered frames that must see a marker (thesis, time order)",
            FromTo(0, 1)},
           {"Registration.num_mean_iterations", &options->num_mean_iterations, "count",
            "iterations of the weighted mean (thesis)", AtLeast(0)},
           {"Registration.mean_sigma", &options->mean_sigma_m, "m",
            "width of the mean's weights (thesis)", MoreThan(0)},
           ChoiceOption("Registration.thesis_variant", &options->variant, kVariants,
                        "exact: sections 3.3 to 3.5 to the letter; robust: both poses of a marker, "
                        "a search that adapts to the video, and a mean that is refined (thesis)")}};
}

OptionGroup DescribeOptions(RegistrationOptions* options) {
  OptionGroup group = {
      "Registration of the frames",
      {Common(ChoiceOption(
           "Registration.method", &options->method, kMethods,
           "thesis: rigid alignment around one central frame; global: resection against a "
           "growing map")),
       ChoiceOption("Registration.frame_order", &options->frame_order, kFrameOrders,
                    "time: search around the central frame; unordered: grow from it; auto: time "
                    "for a video"),
       {"Registration.central_frame",
        &options->central_frame,
        "name|frame",
        "image name or frame number; left out: the best one is chosen",
        {},
        false,
        {"central_frame"}},
       {"Registration.min_num_inliers", &options->min_num_inliers, "markers",
        "minimum number of shared markers that have to agree for a frame to be registered",
        AtLeast(2)},
       {"Registration.min_num_frames", &options->min_num_frames, "frames",
        "minimum number of frames that have to see a marker", AtLeast(2)}}};
  Append(DescribeOptions(&options->global), &group);
  Append(DescribeOptions(&options->thesis), &group);
  return group;
}

void RegistrationOptions::Check() const { CheckRanges(*this); }

}  // namespace velamap
