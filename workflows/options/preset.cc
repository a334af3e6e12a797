#include "workflows/options/preset.h"

#include "importer/base/log.h"

namespace velamap {

Option PresetOption(Preset* preset) {
  return Common(ChoiceOption("preset", &preset->name,
                             {{PresetName::kNone, "none"}, {PresetName::kThesis, "thesis"}},
                             "thesis: chapter 3 of the thesis, step by step, instead of velamap's "
                             "defaults; options that are given beside it take precedence"));
}

const std::map<std::string, std::string>& PresetValues(PresetName name) {
  static const std::map<std::string, std::string> none;
  static const std::map<std::string, std::string> thesis = {
      {"ArucoDetection.corner_refinement", "subpix"},
      {"ArucoDetection.search", "exhaustive"},
      {"BundleAdjustment.refine_extra_params", "0"},
      {"BundleAdjustment.refine_focal_length", "0"},
      {"BundleAdjustment.refine_principal_point", "0"},
      {"BundleAdjustment.remove_outliers", "0"},
      {"Registration.frequency_threshold", "0.3"},
      {"Registration.mean_sigma", "0.6"},
      {"Registration.method", "thesis"},
      {"Registration.neighborhood", "5"},
      {"Registration.num_frames", "20"},
      {"Registration.num_mean_iterations", "30"},
      {"Registration.ransac_max_error", "0.1"},
      {"Registration.skip", "10"},
      {"Registration.thesis_variant", "exact"},
      {"backend", "colmap"},
      {"scale_by", "mean_side"},
      {"warm_start", "0"}};
  return name == PresetName::kThesis ? thesis : none;
}

void LogPreset(const Preset& preset) {
  if (!preset.effect.empty()) LogInfo("{}", preset.effect);
}

}  // namespace velamap
