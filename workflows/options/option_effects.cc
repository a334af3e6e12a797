#include "workflows/options/option_effects.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/log.h"

namespace velamap {
namespace {

bool MatchesNameOrSection(const std::string& name_or_section, const std::string& name) {
  return name_or_section.back() == '.' ? name.rfind(name_or_section, 0) == 0
                                       : name == name_or_section;
}

// The first typed option that one of `names` stands for.
std::optional<std::string> FindTyped(const TypedNames& typed,
                                     const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const auto found = std::find_if(typed.begin(), typed.end(), [&](const std::string& one) {
      return MatchesNameOrSection(name, one);
    });
    if (found != typed.end()) return *found;
  }
  return std::nullopt;
}

std::vector<std::string> NamesIn(const OptionGroup& group) {
  std::vector<std::string> names;
  for (const Option& option : group.options) names.push_back(option.name);
  return names;
}

}  // namespace

void RefuseOptionsWithoutEffect(const TypedNames& typed, const std::vector<std::string>& names,
                                const std::string& reason) {
  const std::optional<std::string> found = FindTyped(typed, names);
  if (!found) return;
  throw InputError(
      fmt::format("--{}: it would change nothing, because {}; leave it out", *found, reason));
}

void WarnOfOptionsWithoutEffect(const TypedNames& typed, const std::vector<std::string>& names,
                                const std::string& reason) {
  const std::optional<std::string> found = FindTyped(typed, names);
  if (found) LogWarning("--{}: it changes nothing, because {}", *found, reason);
}

void RefuseVideoOptions(const CommandOptions& options) {
  const std::string& image_path = options.paths.image_path;
  if (!IsFolder(image_path)) return;
  RefuseOptionsWithoutEffect(
      options.typed,
      {"Video.", "frame_output_path", "ArucoDetection.full_search_interval",
       "MarkerAdjustment.rolling_shutter", "MarkerAdjustment.estimate_rolling_shutter"},
      fmt::format("the pictures in --image_path {} are photographs, not a video", image_path));
}

void RefuseOptionsOfOtherBackend(const TypedNames& typed, AdjustmentBackend backend) {
  if (backend == AdjustmentBackend::kColmap) {
    RefuseOptionsWithoutEffect(
        typed, {"MarkerAdjustment."},
        "--backend colmap adjusts without knowing markers (--backend both or "
        "markers would use it)");
  }
  if (backend == AdjustmentBackend::kMarkers) {
    RefuseOptionsWithoutEffect(
        typed,
        {"BundleAdjustment.function_tolerance", "BundleAdjustment.remove_outliers",
         "BundleAdjustment.max_num_rounds", "BundleAdjustment.outlier_ratio",
         "BundleAdjustment.min_outlier_error", "BundleAdjustment.time_limit", "colmap_path",
         "log_path"},
        "--backend markers adjusts without COLMAP (--backend both or colmap would use it)");
  }
  if (backend != AdjustmentBackend::kColmap) {
    RefuseOptionsWithoutEffect(
        typed, {"scale_by"},
        "the adjustment with markers gives metres (--backend colmap would use it)");
  }
}

void RefuseOptionsOfOtherMethod(const TypedNames& typed, RegistrationMethod method) {
  RegistrationOptions options;
  if (method == RegistrationMethod::kGlobal) {
    RefuseOptionsWithoutEffect(typed, NamesIn(DescribeOptions(&options.thesis)),
                               "--Registration.method is global (thesis would use it)");
  } else {
    RefuseOptionsWithoutEffect(typed, NamesIn(DescribeOptions(&options.global)),
                               "--Registration.method is thesis (global would use it)");
  }
}

void RefuseFixedCameraWithoutCalibration(const TypedNames& typed,
                                         const MarkerAdjustmentOptions& adjustment,
                                         const std::string& missing) {
  const std::string name = OptionName(&MarkerAdjustmentOptions::find_camera);
  if (adjustment.find_camera || typed.count(name.substr(2)) == 0) return;
  throw InputError(fmt::format(
      "{}: 0 needs a calibration, and {}; give one to automatic_reconstructor or marker_importer "
      "(--camera_path), or leave {} out",
      name, missing, name));
}

void RefuseOptionsOfKnownCamera(const TypedNames& typed) {
  RefuseOptionsWithoutEffect(
      typed,
      {"BundleAdjustment.refine_focal_length", "BundleAdjustment.refine_principal_point",
       "BundleAdjustment.refine_extra_params", "MarkerAdjustment.refine_calibration",
       "MarkerAdjustment.intrinsics_sigma"},
      "the camera is unknown, and all of its parameters are refined");
}

void RefuseSailOptions(const TypedNames& typed, const Layout& layout) {
  if (FirstPartWithLines(layout) != nullptr) return;
  RefuseOptionsWithoutEffect(
      typed,
      {"design_path", "Section.", "Surface.luff_extension", "Surface.leech_extension",
       "Surface.foot_extension", "Surface.head_extension", "Surface.edges_path",
       "Surface.grid_sections", "Surface.grid_points"},
      "no part of the layout has horizontal lines, which sections and the surface of a sail need");
}

}  // namespace velamap
