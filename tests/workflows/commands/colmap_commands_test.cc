// Commands that run COLMAP: the real one, and scripts that fail as it can.

#include "reconstruct/model/model_io.h"
#include "tests/workflows/commands/stages_fixture.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;

// A database of a synthetic scene and its seed model.
class ColmapCommandsTest : public StagesTest {
 protected:
  void SetUp() override {
    SyntheticSceneOptions options;
    options.num_rows = 3;
    options.num_columns = 4;
    options.num_frames = 8;
    SyntheticScene scene = MakeSyntheticScene(options);
    AddNoise({0.2, 0.0, 0.0, 0.0, 1}, &scene);
    WriteDatabase(scene, path("database.db"), options.num_frames, All);
    const ProgramRun run =
        RunVelamap({"frame_registrator", "--database_path", path("database.db"), "--marker_length",
                    "0.1", "--output_path", path("seed"), "--registration_path", path("table.csv"),
                    "--Registration.frame_order", "unordered"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }

  ProgramRun Adjust(const std::string& colmap_path) {
    return RunVelamap({"bundle_adjuster", "--input_path", path("seed"), "--output_path",
                       path("adjusted"), "--colmap_path", colmap_path});
  }

  // COLMAP up to the moment that it is to adjust.
  std::string FakeColmap(const std::string& what_it_does) {
    WriteTextFile(dir_ / "fake_colmap",
                  "#!/bin/sh\n"
                  "for argument in \"$@\"; do\n"
                  "  case \"$argument\" in -h|--help|help) exec colmap \"$@\" ;; esac\n"
                  "done\n" +
                      what_it_does + "\n");
    fs::permissions(dir_ / "fake_colmap", fs::perms::owner_all);
    return path("fake_colmap");
  }

  void ExpectFailure(const ProgramRun& run) {
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_THAT(run.err, HasSubstr("error: "));
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
    EXPECT_FALSE(fs::exists(dir_ / "adjusted"));
    // The temporary folders are gone too.
    for (const std::string& name : ListFolder(dir_.path())) EXPECT_NE(name.front(), '.') << name;
  }
};

TEST_F(ColmapCommandsTest, AdjustsAndExports) {
  const ProgramRun run = Adjust("colmap");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("reprojection_error_px: mean 0."));
  EXPECT_EQ(ReadModel(path("adjusted")).images.size(), ReadModel(path("seed")).images.size());
  EXPECT_TRUE(fs::exists(dir_ / "colmap.log"));
  const ProgramRun shape = RunVelamap({"shape_exporter", "--input_path", path("adjusted"),
                                       "--marker_length", "0.1", "--shape_path", path("shape")});
  ASSERT_EQ(shape.exit_code, 0) << shape.err;
  EXPECT_THAT(shape.out, HasSubstr("markers_reconstructed: 12\n"));
}

TEST_F(ColmapCommandsTest, Absent) {
  const ProgramRun run = Adjust(path("nowhere"));
  ExpectFailure(run);
  EXPECT_THAT(run.err, HasSubstr("nowhere"));
}

TEST_F(ColmapCommandsTest, FailsWithAStatus) {
  const ProgramRun run = Adjust(FakeColmap("echo out of luck; exit 7"));
  ExpectFailure(run);
  EXPECT_THAT(run.err, HasSubstr("colmap.log"));
  EXPECT_THAT(ReadFileBytes(path("colmap.log")), HasSubstr("out of luck"));
}

TEST_F(ColmapCommandsTest, IsKilled) { ExpectFailure(Adjust(FakeColmap("kill -9 $$"))); }

TEST_F(ColmapCommandsTest, SaysItIsDoneAndWritesNothing) {
  ExpectFailure(Adjust(FakeColmap("exit 0")));
}

TEST_F(ColmapCommandsTest, FailureKeepsTheOldModel) {
  ASSERT_EQ(Adjust("colmap").exit_code, 0);
  const std::string before = ReadFileBytes(path("adjusted/points3D.bin"));
  EXPECT_EQ(Adjust(FakeColmap("exit 1")).exit_code, 3);
  EXPECT_EQ(ReadFileBytes(path("adjusted/points3D.bin")), before);
}

}  // namespace
}  // namespace velamap
