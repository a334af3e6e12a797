// Compares the precision that shoot_planner predicts with the result and the truth of a clip
// rendered along the planned path.

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

// The value of a line `key: value ...`; NaN without one.
double ValueOf(const std::string& text, const std::string& key) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind(key + ": ", 0) == 0) return std::stod(line.substr(key.size() + 2));
  }
  return std::nan("");
}

TEST(PlannedClipTest, SigmasOfThePlanAreThoseOfTheClip) {
  TempDir dir;
  const std::string clip = (dir / "clip").string(), workspace = (dir / "workspace").string();
  const ProgramRun render =
      RunProgram(RENDER_CLIP_PROGRAM,
                 {"--output_path", clip,  "--camera",   "action", "--tone_curve",     "srgb",
                  "--sail_scale",  "0.5", "--distance", "3",      "--drift_deg",      "35",
                  "--num_frames",  "40",  "--fps",      "8",      "--motion_blur_px", "1",
                  "--crf",         "21"});
  ASSERT_EQ(render.exit_code, 0) << render.err;
  const ProgramRun plan =
      RunVelamap({"shoot_planner", "--camera_path", clip + "/camera.yml", "--layout_path",
                  clip + "/layout.yml", "--shape_path", clip + "/truth.csv", "--Plan.distance", "3",
                  "--Plan.arc", "70", "--Plan.num_views", "40"});
  ASSERT_EQ(plan.exit_code, 0) << plan.err;
  const ProgramRun run = RunVelamap({"automatic_reconstructor", "--image_path", clip + "/clip.mp4",
                                     "--camera_path", clip + "/camera.yml", "--layout_path",
                                     clip + "/layout.yml", "--workspace_path", workspace});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const ProgramRun result =
      RunVelamap({"shape_analyzer", "--shape_path", workspace + "/shape", "--input_path",
                  workspace + "/sparse/0", "--layout_path", clip + "/layout.yml",
                  "--reference_path", clip + "/truth.csv"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  constexpr double kFactor = 1.5;
  for (const std::string key : {"distance_sigma_mm", "distance_after_scaling_sigma_mm"}) {
    const double planned_mm = ValueOf(plan.out, key), found_mm = ValueOf(result.out, key);
    RecordProperty(key, std::to_string(planned_mm) + " " + std::to_string(found_mm));
    EXPECT_LT(planned_mm, kFactor * found_mm) << key;
    EXPECT_GT(planned_mm, found_mm / kFactor) << key;
  }
  const double planned_mm = ValueOf(plan.out, "distance_after_scaling_sigma_mm");
  const double true_mm = ValueOf(result.out, "distance_after_scaling_mm_rms");
  EXPECT_LT(true_mm, 2 * planned_mm);
  EXPECT_GT(true_mm, planned_mm / 3);
  EXPECT_LT(ValueOf(result.out, "distance_mm_rms"), 2 * ValueOf(plan.out, "distance_sigma_mm"));
}

}  // namespace
}  // namespace velamap
