// A rendered clip of a sail through the whole program, against its exact truth.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/formats/shape_csv.h"
#include "exporters/shape/shape_metrics.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;

ProgramRun RenderClip(const std::vector<std::string>& arguments) {
  return RunProgram(RENDER_CLIP_PROGRAM, arguments);
}

TEST(RenderClipTest, SailComesBackFromItsVideo) {
  TempDir dir;
  const std::string clip = (dir / "clip").string(), workspace = (dir / "workspace").string();
  const ProgramRun render =
      RenderClip({"--output_path", clip, "--width", "1280", "--num_frames", "80", "--sail_scale",
                  "0.5", "--distance", "3", "--fps", "15"});
  ASSERT_EQ(render.exit_code, 0) << render.err;
  const ProgramRun run = RunVelamap({"automatic_reconstructor", "--image_path", clip + "/clip.mp4",
                                     "--camera_path", clip + "/camera.yml", "--layout_path",
                                     clip + "/layout.yml", "--workspace_path", workspace});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const ReferenceMetrics comparison = ComputeReferenceMetrics(
      ReadShapeCsv(workspace + "/shape/shape.csv"), ReadShapeCsv(clip + "/truth.csv"));
  RecordProperty("rms_mm", std::to_string(1e3 * comparison.distance_m.rms));
  RecordProperty("scale", std::to_string(comparison.scale));
  const std::size_t num_markers = ReadShapeCsv(clip + "/truth.csv").markers.size();
  EXPECT_GE(comparison.num_points, static_cast<int>(0.9 * 4 * num_markers));
  EXPECT_LT(comparison.distance_m.rms, 0.005);
  EXPECT_NEAR(comparison.scale, 1.0, 0.005);
  const ProgramRun judged =
      RunVelamap({"shape_analyzer", "--shape_path", workspace + "/shape/shape.csv",
                  "--reference_path", clip + "/truth.csv"});
  EXPECT_EQ(judged.exit_code, 0) << judged.err;
  EXPECT_THAT(judged.out, HasSubstr("scale_error_percent: "));
}

TEST(RenderClipTest, SameArgumentsSameBytes) {
  TempDir dir;
  const auto render = [&](const std::string& name, const std::string& num_threads) {
    const std::string folder = (dir / name).string();
    const ProgramRun run = RenderClip({"--output_path", folder, "--width", "640", "--num_frames",
                                       "5", "--num_threads", num_threads});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return ReadFileBytes(folder + "/clip.mp4");
  };
  EXPECT_EQ(render("one", "1"), render("two", "3"));
}

TEST(RenderClipTest, BadOptionsAreNamed) {
  TempDir dir;
  const ProgramRun run = RenderClip({"--output_path", (dir / "clip").string(), "--scene", "kite"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--scene: 'kite' is unknown"));
  const std::vector<std::pair<std::vector<std::string>, std::string>> faults = {
      {{"--camera", "film"}, "--camera: 'film' is unknown; give one of action plain"},
      {{"--gamma", "2"}, "--gamma: has no effect here; give --tone_curve gamma"},
      {{"--camera", "action", "--s_curve", "0.5"}, "--s_curve: 0.5 is out of range"},
      {{"--margin_sides", "0.4"}, "--margin_sides: 0.4 makes stickers overlap"},
  };
  for (const auto& [arguments, message] : faults) {
    std::vector<std::string> all = {"--output_path", (dir / "clip").string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ProgramRun fault = RenderClip(all);
    EXPECT_EQ(fault.exit_code, 2);
    EXPECT_THAT(fault.err, HasSubstr(message));
  }
}

// A usual action camera is the default; --camera chooses defaults, and what is given beside it
// counts.
TEST(RenderClipTest, CameraChoosesDefaults) {
  TempDir dir;
  const auto options_of = [&](const std::string& name, std::vector<std::string> arguments) {
    const std::string folder = (dir / name).string();
    for (const char* argument : {"--width", "640", "--num_frames", "1", "--format", "png"}) {
      arguments.push_back(argument);
    }
    arguments.insert(arguments.end(), {"--output_path", folder});
    const ProgramRun run = RenderClip(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return ReadFileBytes(folder + "/scene.ini");
  };
  const std::string action = options_of("action", {"--glare", "0.07"});
  EXPECT_THAT(action, HasSubstr("\nglare=0.07\n"));
  EXPECT_THAT(action, HasSubstr("\nsharpening=0.5\n"));
  EXPECT_THAT(action, HasSubstr("\ntone_curve=s_curve\n"));
  const std::string plain = options_of("plain", {"--glare", "0.07", "--camera", "plain"});
  EXPECT_THAT(plain, HasSubstr("\nglare=0.07\n"));
  EXPECT_THAT(plain, HasSubstr("\nsharpening=0\n"));
  EXPECT_THAT(plain, HasSubstr("\ntone_curve=linear\n"));
}

}  // namespace
}  // namespace velamap
