#include "reconstruct/colmap/bundle_adjustment_options.h"

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {

Option ColmapPathOption(BundleAdjustmentOptions* options) {
  return PathOption("colmap_path", PathUse::kReadsFile, &options->colmap_path, "COLMAP's program");
}

OptionGroup DescribeOptions(BundleAdjustmentOptions* options) {
  return {"Bundle adjustment",
          {ColmapPathOption(options),
           {"BundleAdjustment.refine_focal_length", &options->refine_focal_length, "0|1",
            "adjust the focal length of the calibration"},
           {"BundleAdjustment.refine_principal_point", &options->refine_principal_point, "0|1",
            "adjust the principal point"},
           {"BundleAdjustment.refine_extra_params", &options->refine_extra_params, "0|1",
            "adjust the distortion"},
           {"BundleAdjustment.max_num_iterations", &options->max_num_iterations, "count",
            "maximum number of iterations per round", AtLeast(1)},
           {"BundleAdjustment.function_tolerance", &options->function_tolerance, "fraction",
            "a smaller relative change of the cost ends a round", AtLeast(0)},
           {"BundleAdjustment.remove_outliers", &options->remove_outliers, "0|1",
            "leave out what does not fit, and adjust again; 0: COLMAP's adjustment alone, once"},
           {"BundleAdjustment.max_num_rounds", &options->max_num_rounds, "count",
            "maximum number of rounds of adjustment and removal of outliers", AtLeast(1)},
           {"BundleAdjustment.outlier_ratio", &options->outlier_ratio, "sigmas",
            "errors beyond this many robust sigmas are outliers", AtLeast(2)},
           {"BundleAdjustment.min_outlier_error", &options->min_outlier_error_px, "px",
            "errors below this are never outliers", AtLeast(0)},
           {"BundleAdjustment.min_track_length", &options->min_track_length, "images",
            "minimum number of images that have to see a corner", AtLeast(2)},
           {"BundleAdjustment.time_limit", &options->time_limit_min, "minutes",
            "a run of COLMAP that takes longer is ended", FromTo(0.001, 10080)},
           {"BundleAdjustment.max_mean_error", &options->max_mean_error_px, "px",
            "a result with a larger mean reprojection error is refused", AtLeast(0)}}};
}

void BundleAdjustmentOptions::Check() const {
  if (colmap_path.empty()) {
    throw InputError(OptionName(&BundleAdjustmentOptions::colmap_path) +
                     ": is empty; give COLMAP's program");
  }
  CheckRanges(*this);
}

void CheckMeanError(double mean_error_px, double max_mean_error_px, bool has_calibration) {
  if (mean_error_px <= max_mean_error_px) return;
  const std::string text = fmt::format(
      "the mean reprojection error is {:.2f} px after the bundle adjustment, above the {:.2f} px",
      mean_error_px, max_mean_error_px);
  throw DataError(has_calibration
                      ? fmt::format("{} of {}; does the calibration belong to these images?", text,
                                    OptionName(&BundleAdjustmentOptions::max_mean_error_px))
                      : text +
                            " that a right model stays below; give only images of one camera, "
                            "one zoom and one state of the surface");
}

void ThrowFoldedDistortion(CameraId camera_id) {
  throw InputError(fmt::format(
      "{} 1: the images do not determine the distortion of camera {}, which would fold over inside "
      "the image; leave the option out, or add images in which markers reach its corners",
      OptionName(&BundleAdjustmentOptions::refine_extra_params), camera_id));
}

}  // namespace velamap
