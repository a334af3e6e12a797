// The program's surface: commands, help, exit codes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scoped_date.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

const std::vector<std::string> kCommands = {
    "marker_generator",        "shoot_planner",   "camera_calibrator", "clip_checker",
    "automatic_reconstructor", "marker_importer", "database_merger",   "frame_registrator",
    "bundle_adjuster",         "shape_exporter",  "shape_analyzer",    "shape_comparer",
    "central_frame_sweeper",   "version"};

TEST(CommandLineTest, HelpListsAllCommands) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{},
                                                    {"help"},
                                                    {"--help"},
                                                    {"-h"},
                                                    {"help", "help"},
                                                    {"help", "--help"},
                                                    {"help", "-h"},
                                                    {"--help", "help"}}) {
    const ProgramRun run = RunVelamap(arguments);
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_THAT(run.err, IsEmpty());
    for (const std::string& command : kCommands) EXPECT_THAT(run.out, HasSubstr("  " + command));
  }
}

TEST(CommandLineTest, EveryCommandExplainsItself) {
  for (const std::string& command : kCommands) {
    const ProgramRun run = RunVelamap({command, "--help"});
    EXPECT_EQ(run.exit_code, 0) << command;
    EXPECT_THAT(run.out, StartsWith("velamap " + command + ": "));
    EXPECT_THAT(run.out, HasSubstr("Example:\n  velamap " + command + " --"));
    EXPECT_EQ(RunVelamap({"help", command}).out, run.out);
  }
}

TEST(CommandLineTest, HelpInTwoLengths) {
  const std::string shown = RunVelamap({"automatic_reconstructor", "--help"}).out;
  EXPECT_THAT(shown, HasSubstr("--layout_path path"));
  EXPECT_THAT(shown, Not(HasSubstr("--MarkerAdjustment.")));
  EXPECT_THAT(shown, HasSubstr(" more options: velamap automatic_reconstructor --help_all\n"));
  const std::string all = RunVelamap({"automatic_reconstructor", "--help_all"}).out;
  EXPECT_THAT(all, HasSubstr("--MarkerAdjustment.inset_sigma px"));
  EXPECT_THAT(all, Not(HasSubstr(" more options")));
  EXPECT_EQ(RunVelamap({"help", "automatic_reconstructor", "--help_all"}).out, all);
}

TEST(CommandLineTest, CommandsAreListedInGroups) {
  const std::string out = RunVelamap({"help"}).out;
  EXPECT_THAT(out, HasSubstr("\nThe same in steps:\n  marker_importer"));
  EXPECT_THAT(out, HasSubstr("\nAbout velamap:\n  version"));
}

TEST(CommandLineTest, HelpOfAnUnknownCommandNamesTheNearest) {
  const ProgramRun run = RunVelamap({"help", "bundle_adjustr"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("did you mean bundle_adjuster?"));
}

TEST(CommandLineTest, HelpShowsDefaultsWithUnits) {
  const std::string out = RunVelamap({"automatic_reconstructor", "--help_all"}).out;
  EXPECT_THAT(out, HasSubstr("--ArucoDetection.corner_refinement none|subpix|edge (=edge)"));
  EXPECT_THAT(out, HasSubstr("--BundleAdjustment.min_outlier_error px (=0.5)"));
  EXPECT_THAT(out, HasSubstr("--Registration.mean_sigma m (=0.6)"));
  EXPECT_THAT(out, HasSubstr("--Registration.frame_order auto|time|unordered (=auto)"));
  EXPECT_THAT(out, HasSubstr("--Video.last_frame frame (=-1)"));
}

TEST(CommandLineTest, VersionNamesWhatItWorksWith) {
  const ProgramRun run = RunVelamap({"version", "--colmap_path", "/nowhere/colmap"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, StartsWith("velamap: " VELAMAP_VERSION "\n"));
  EXPECT_THAT(run.out, HasSubstr("\nopencv: 4."));
  EXPECT_THAT(run.out, HasSubstr("\ncolmap: not found (/nowhere/colmap)\n"));
  EXPECT_EQ(RunVelamap({"--version"}).exit_code, 0);
}

TEST(CommandLineTest, UnknownCommandNamesTheNearest) {
  const ProgramRun run = RunVelamap({"marker_imprter", "--image_path", "x"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, StartsWith("error: marker_imprter: unknown command; did you mean "
                                  "marker_importer?"));
  EXPECT_THAT(run.err, HasSubstr("--help"));
  EXPECT_EQ(NumErrorLines(run.err), 1);
  EXPECT_THAT(run.out, IsEmpty());
}

TEST(CommandLineTest, UnknownOptionNamesTheNearest) {
  const ProgramRun run = RunVelamap({"marker_importer", "--Video.frame_stp", "2"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--Video.frame_stp"));
  EXPECT_THAT(run.err, HasSubstr("did you mean --Video.frame_step?"));
  EXPECT_THAT(run.err, HasSubstr("velamap marker_importer --help"));
  EXPECT_EQ(NumErrorLines(run.err), 1);
}

TEST(CommandLineTest, ProjectFileServesAllCommands) {
  const TempDir temp_dir;
  const std::string file = (temp_dir / "project.ini").string();
  WriteTextFile(file,
                "database_path=/nowhere/database.db\nimage_path=/nowhere\nlayout_path=/nowhere\n"
                "workspace_path=/nowhere\noutput_path=/nowhere\nshape_path=/nowhere\n"
                "log_path=/nowhere\ninput_path=/nowhere\ncentral_frame=3\n"
                "[Video]\nframe_step=2\n[Registration]\nmin_num_inliers=1\n");
  const ProgramRun run = RunVelamap(
      {"frame_registrator", "--project_path", file, "--output_path", (temp_dir / "seed").string()});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr(file + ": Registration.min_num_inliers: 1 is out of range"));

  WriteTextFile(file, "[Registration]\nmin_inliers=3\n");
  const ProgramRun unknown = RunVelamap({"frame_registrator", "--project_path", file});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr(file + ": unknown key Registration.min_inliers; did you mean "
                                            "Registration.min_num_inliers?"));
  EXPECT_EQ(NumErrorLines(unknown.err), 1);
}

TEST(CommandLineTest, OldNamesAreUnderstoodWithAWarning) {
  const ProgramRun prior = RunVelamap({"marker_importer", "--image_path", "/n", "--camera_path",
                                       "/n", "--database_path", "/out", "--map_path", "/n"});
  EXPECT_EQ(prior.exit_code, 2);
  EXPECT_THAT(prior.err, HasSubstr("--map_path: an old name; write --prior_shape_path"));
  const ProgramRun backend = RunVelamap(
      {"bundle_adjuster", "--input_path", "/n", "--output_path", "/out", "--backend", "ceres"});
  EXPECT_EQ(backend.exit_code, 2);
  EXPECT_THAT(backend.err, HasSubstr("--backend ceres: an old name; write markers"));
  EXPECT_THAT(backend.err, HasSubstr("--layout_path: missing"));  // which markers needs
  for (const ProgramRun& run : {prior, backend}) EXPECT_EQ(NumErrorLines(run.err), 1);
}

TEST(CommandLineTest, TwoNamesOfOneOptionAreAnError) {
  const ProgramRun central = RunVelamap(
      {"frame_registrator", "--central_frame", "3", "--Registration.central_frame", "3"});
  EXPECT_EQ(central.exit_code, 2);
  EXPECT_THAT(central.err,
              HasSubstr("--central_frame and --Registration.central_frame: two names"));
  const ProgramRun prior =
      RunVelamap({"marker_importer", "--prior_shape_path", "a", "--map_path", "a"});
  EXPECT_EQ(prior.exit_code, 2);
  EXPECT_THAT(prior.err, HasSubstr("--prior_shape_path and --map_path: two names"));
}

TEST(CommandLineTest, UnknownNamesListWhatThereIs) {
  const auto error_of = [](const std::string& option, const std::string& value) {
    const ProgramRun run =
        RunVelamap({"automatic_reconstructor", "--image_path", "/n", "--camera_path", "/n",
                    "--workspace_path", "/n", option, value});
    EXPECT_EQ(run.exit_code, 2) << option;
    return run.err;
  };
  EXPECT_THAT(error_of("--Registration.method", "local"), HasSubstr("thesis or global"));
  EXPECT_THAT(error_of("--Registration.frame_order", "random"),
              HasSubstr("auto, time or unordered"));
  EXPECT_THAT(error_of("--ArucoDetection.corner_refinement", "contour"),
              HasSubstr("none, subpix or edge"));
  EXPECT_THAT(error_of("--log_level", "loud"), HasSubstr("error, warn, info or debug"));
  EXPECT_THAT(error_of("--log_level", "warning"), Not(HasSubstr("--log_level")));
  const ProgramRun backend = RunVelamap(
      {"bundle_adjuster", "--input_path", "/n", "--output_path", "/out", "--backend", "g2o"});
  EXPECT_EQ(backend.exit_code, 2);
  EXPECT_THAT(backend.err, HasSubstr("--backend: 'g2o' is unknown; give colmap, markers or both"));
  const ProgramRun length = RunVelamap(
      {"bundle_adjuster", "--input_path", "/n", "--output_path", "/out", "--backend", "markers"});
  EXPECT_EQ(length.exit_code, 2);
  EXPECT_THAT(length.err, HasSubstr("--layout_path: missing"));
}

TEST(CommandLineTest, ADateThatIsNoneIsRefusedBeforeTheWork) {
  const ScopedDate date("yesterday");
  const ProgramRun run = RunVelamap({"marker_importer", "--image_path", "/n", "--database_path",
                                     "/out/new.db", "--marker_length", "0.1"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("SOURCE_DATE_EPOCH: expected seconds since 1970"));
  EXPECT_EQ(NumErrorLines(run.err), 1);
}

TEST(CommandLineTest, FullStandardOutputIsNoSuccess) {
  const ProgramRun run = RunProgram("/bin/sh", {"-c", VELAMAP_PROGRAM " help > /dev/full"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(NumErrorLines(run.err), 1);
}

}  // namespace
}  // namespace velamap
