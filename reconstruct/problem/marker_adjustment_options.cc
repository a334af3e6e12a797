#include "reconstruct/problem/marker_adjustment_options.h"

#include "reconstruct/colmap/bundle_adjustment_options.h"

namespace velamap {
namespace {

const Choices<BentMarkers> kBentMarkers = {
    {BentMarkers::kAuto, "auto"}, {BentMarkers::kStiff, "0"}, {BentMarkers::kBent, "1"}};

}  // namespace

FreeIntrinsics FreeIntrinsicsOf(const MarkerAdjustmentOptions& options) {
  if (options.find_camera) return {true, true, true};
  return {options.refine_focal_length, options.refine_principal_point, options.refine_extra_params};
}

OptionGroup DescribeOptions(MarkerAdjustmentOptions* options) {
  return {"Marker-aware adjustment (--backend markers or both)",
          {{"MarkerAdjustment.corner_sigma", &options->corner_sigma_px, "px",
            "1 sigma of a corner's coordinate where the detector gives none", FromTo(1e-4, 100)},
           {"MarkerAdjustment.corner_sigma_floor", &options->corner_sigma_floor_px, "px",
            "added to every corner's own sigma (root of the sum of squares)", FromTo(0, 100)},
           {"MarkerAdjustment.loss", &options->loss_sigmas, "sigmas",
            "errors beyond this lose weight", FromTo(1, 1000)},
           {"MarkerAdjustment.outlier", &options->outlier_sigmas, "sigmas",
            "corners beyond this are left out", FromTo(2, 1000)},
           {"MarkerAdjustment.print_tolerance", &options->print_tolerance, "fraction",
            "1 sigma of each printed side", FromTo(1e-6, 0.5)},
           {"MarkerAdjustment.print_resolution", &options->print_resolution_m, "m",
            "1 sigma of each printed side due to the printer's dots, whatever its length; added to "
            "print_tolerance (root of the sum of squares)",
            FromTo(0, 0.01)},
           {"MarkerAdjustment.common_print_tolerance", &options->common_print_tolerance, "fraction",
            "1 sigma of the print as a whole; widens the scale's sigma; distances with use: scale "
            "overrule it",
            FromTo(0, 0.5)},
           {"MarkerAdjustment.cloth_flatness", &options->cloth_flatness, "fraction",
            "1 sigma of a corner's distance from its marker's plane, relative to the side; 0: "
            "unknown",
            FromTo(0, 1)},
           {"MarkerAdjustment.rigid_flatness", &options->rigid_flatness, "fraction",
            "the same on parts that the layout calls rigid", FromTo(0, 1)},
           ChoiceOption("MarkerAdjustment.bent_markers", &options->bent_markers, kBentMarkers,
                        "1: markers bend with a curved surface, so their sides are the chords of "
                        "arcs as long as printed; 0: they are stiff; auto: their proportions "
                        "and the residuals decide"),
           {"MarkerAdjustment.inset_sigma", &options->inset_sigma_px, "px",
            "1 sigma of an inset that all corners share (seen too far inside their marker), beyond "
            "what the importer leaves open; widens the scale's sigma",
            FromTo(0, 10)},
           {"MarkerAdjustment.estimate_inset", &options->estimate_inset, "0|1",
            "estimate the inset from the images"},
           {"MarkerAdjustment.refine_calibration", &options->refine_calibration, "0|1",
            "refine the calibration where the images determine it better and contradict it; "
            "ignored with an option BundleAdjustment.refine_*"},
           {"MarkerAdjustment.find_camera", &options->find_camera, "0|1",
            "estimate an unknown camera: refine all parameters, with a prior that holds for any "
            "camera; set if there is no calibration"},
           {"MarkerAdjustment.intrinsics_sigma", &options->intrinsics_sigma, "fraction",
            "1 sigma of a calibration that is refined: of the focal length, and of how far each "
            "distortion parameter moves the image's corners",
            FromTo(1e-9, 10)},
           {"MarkerAdjustment.rolling_shutter", &options->rolling_shutter_s, "s",
            "time from the first row of a video's frame to the last, or from the left column of a "
            "portrait frame to the right; negative: the other way; 0: unknown",
            FromTo(-0.1, 0.1)},
           {"MarkerAdjustment.estimate_rolling_shutter", &options->estimate_rolling_shutter, "0|1",
            "estimate that time where the frames show it"}}};
}

void MarkerAdjustmentOptions::Check() const {
  CheckRanges(*this);
  BundleAdjustmentOptions shared;
  shared.max_num_iterations = max_num_iterations;
  shared.min_track_length = min_track_length;
  shared.max_mean_error_px = max_mean_error_px;
  shared.Check();
}

}  // namespace velamap
