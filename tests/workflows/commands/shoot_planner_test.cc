// The command shoot_planner: its files, and input that it refuses.

#include <gmock/gmock.h>

#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::vector<std::string> kSail = {"shoot_planner",
                                        "--field_of_view",
                                        "90",
                                        "--marker_length",
                                        "0.1",
                                        "--Sail.luff",
                                        "4",
                                        "--Sail.foot",
                                        "2",
                                        "--Sail.leech",
                                        "4.2",
                                        "--Sail.lines",
                                        "3",
                                        "--Plan.num_views",
                                        "10"};

ProgramRun RunWith(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return RunVelamap(arguments);
}

TEST(ShootPlannerTest, WritesTheSamePlanTwice) {
  TempDir dir;
  const std::string folder = (dir / "plan").string();
  const ProgramRun first = RunWith(kSail, {"--output_path", folder, "--hull_markers", "4"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(ListFolder(folder),
            (std::vector<std::string>{".velamap", "markers.csv", "plan.csv", "plan.svg"}));
  const std::string svg = ReadFileBytes(folder + "/plan.svg");
  const ProgramRun second = RunWith(kSail, {"--output_path", folder, "--hull_markers", "4"});
  EXPECT_EQ(first.out, second.out);
  EXPECT_EQ(svg, ReadFileBytes(folder + "/plan.svg"));
}

TEST(ShootPlannerTest, ACalibrationThatFoldsOverIsAWarning) {
  const TempDir dir;
  const std::string camera_path = (dir / "cameras.txt").string();
  const auto run_with_distortion = [&](const std::string& k1) {
    WriteTextFile(camera_path, "1 OPENCV 1920 1080 1400 1400 960 540 " + k1 + " 0 0 0\n");
    return RunVelamap({"shoot_planner", "--camera_path", camera_path, "--marker_length", "0.1"});
  };
  const std::string warning = "cameras.txt: the distortion folds over";
  EXPECT_THAT(run_with_distortion("-0.9").err, HasSubstr(warning));
  EXPECT_THAT(run_with_distortion("-0.1").err, Not(HasSubstr(warning)));
}

TEST(ShootPlannerTest, InputThatMakesNoPlanIsNamed) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> faults = {
      {{"shoot_planner", "--marker_length", "0.1"}, "--camera_path: missing"},
      {{"shoot_planner", "--field_of_view", "90"}, "--layout_path: missing"},
      {{"shoot_planner", "--field_of_view", "90", "--marker_length", "0.1"},
       "--Sail.luff: missing"},
      {{"shoot_planner", "--field_of_view", "90", "--marker_length", "9", "--Sail.luff", "4",
        "--Sail.foot", "2", "--Sail.leech", "4.2"},
       "the sail has no room"},
      {{"shoot_planner", "--field_of_view", "90", "--marker_length", "0.1", "--Plan.speed", "1",
        "--Plan.speed_knots", "2"},
       "--Plan.speed_knots"},
      {{"shoot_planner", "--camera_path", "none.yml", "--field_of_view", "90", "--marker_length",
        "0.1"},
       "--field_of_view"},
      {{"shoot_planner", "--field_of_view", "90", "--marker_length", "0.1", "--shape_path",
        "none.csv"},
       "none.csv"},
      {{"shoot_planner", "--camera_path", "none.yml", "--marker_length", "0.1"}, "none.yml"},
  };
  for (const auto& [arguments, message] : faults) {
    const ProgramRun run = RunVelamap(arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr(message));
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
  }
  const ProgramRun far = RunWith(kSail, {"--Plan.distance", "90"});
  EXPECT_EQ(far.exit_code, 2);
  EXPECT_THAT(far.err, HasSubstr("--Plan.distance: from 90 m"));
  const ProgramRun near = RunWith(kSail, {"--Plan.distance", "0.1"});
  EXPECT_EQ(near.exit_code, 2);
  EXPECT_THAT(near.err, HasSubstr("0 % are in the picture"));
}

}  // namespace
}  // namespace velamap
