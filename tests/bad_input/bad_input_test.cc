// The table of bad input: the exit code, one line that names the fault, and no file that is new,
// changed or gone.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bad_input/sandbox.h"
#include "tests/support/temp_dir.h"
#include "workflows/commands/program.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;

std::vector<BadInput> AllCases() {
  std::vector<BadInput> cases;
  for (const auto& some : {OutputCases(), SourceCases(), InputCases(), FileCases(), ProcessCases(),
                           CommandCases(), WishCases()}) {
    cases.insert(cases.end(), some.begin(), some.end());
  }
  return cases;
}

class BadInputTest : public testing::TestWithParam<BadInput> {
 protected:
  static void SetUpTestSuite() {
    sandbox_ = new TempDir;
    MakeSandbox(sandbox_->path());
  }
  static void TearDownTestSuite() { delete sandbox_; }

  static TempDir* sandbox_;
};

TempDir* BadInputTest::sandbox_ = nullptr;

TEST_P(BadInputTest, IsRefusedInOneLineAndChangesNothing) {
  const BadInput& bad = GetParam();
  const TempDir dir;
  fs::copy(sandbox_->path(), dir.path(), fs::copy_options::recursive);
  if (bad.spoil) bad.spoil(dir.path());
  auto before = ContentOf(dir.path());
  const ProgramRun run = RunInChild("velamap", ArgumentsIn(dir.path(), bad.command), {}, Main);
  auto after = ContentOf(dir.path());
  EXPECT_EQ(run.exit_code, bad.exit_code) << run.err;
  EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("error: "));
  EXPECT_THAT(run.err, HasSubstr(bad.word));
  EXPECT_EQ(run.out, "");
  for (const std::string& name : bad.may_change) {
    before.erase(name);
    after.erase(name);
  }
  EXPECT_EQ(after, before);
}

INSTANTIATE_TEST_SUITE_P(Cases, BadInputTest, testing::ValuesIn(AllCases()),
                         [](const auto& bad) { return bad.param.name; });

// One line where no thread can be started: by the import, and by the adjustment of what is
// imported.
TEST(BadSystem, RefusesThreads) {
  const TempDir dir;
  MakeSandbox(dir.path());
  fs::permissions(dir.path(), fs::perms::all);
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(dir.path())) {
    fs::permissions(entry.path(), fs::perms::all);
  }
  ProgramLimits limits;
  limits.has_no_threads = true;
  for (const std::string& command : {kImport, kRerun}) {
    const ProgramRun run = RunVelamap(ArgumentsIn(dir.path(), command), limits);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr("the system cannot start more threads"));
    EXPECT_THAT(run.err, HasSubstr("(ulimit -u)"));
  }
}

// What the cases spoil is good.
TEST(BadInputSandbox, IsGood) {
  const TempDir dir;
  MakeSandbox(dir.path());
  for (const std::string& command :
       {kRerun, kImport,
        std::string("marker_importer --image_path @/clip.avi --camera_path @/camera.yml "
                    "--layout_path @/layout.yml --database_path @/clip.db --frame_output_path "
                    "@/frames"),
        std::string("shape_analyzer --shape_path @/workspace/shape --layout_path @/layout.yml "
                    "--csv_path @/out.csv")}) {
    for (int i = 0; i < 2; ++i) {
      const ProgramRun run = RunVelamap(ArgumentsIn(dir.path(), command));
      EXPECT_EQ(run.exit_code, 0) << run.err;
    }
  }
  EXPECT_EQ(ListFolder(dir / "workspace/images").size(), 4u);
  EXPECT_EQ(ListFolder(dir / "frames").size(), 4u);
}

TEST(BadInputSandbox, WhatStepCommandsLeaveIsAWorkspace) {
  const TempDir dir;
  MakeSandbox(dir.path());
  fs::create_directory(dir / "steps");
  const std::string layout = "--layout_path @/layout.yml ";
  for (const std::string& command :
       {"marker_importer --image_path @/images --camera_path @/camera.yml --database_path "
        "@/steps/database.db " +
            layout,
        "frame_registrator --database_path @/steps/database.db --output_path @/steps/sparse/seed " +
            layout,
        "bundle_adjuster --backend markers --input_path @/steps/sparse/seed --output_path "
        "@/steps/adjusted --database_path @/steps/database.db " +
            layout,
        "shape_exporter --input_path @/steps/adjusted --output_path @/steps/sparse/0 --shape_path "
        "@/steps/shape " +
            layout,
        "automatic_reconstructor --image_path @/images --camera_path @/camera.yml --backend "
        "markers "
        "--workspace_path @/steps " +
            layout}) {
    const ProgramRun run = RunVelamap(ArgumentsIn(dir.path(), command));
    EXPECT_EQ(run.exit_code, 0) << command << ": " << run.err;
  }
}

TEST(BadInputSandbox, WhatHasChangedIsImportedAnewOnRequest) {
  const TempDir dir;
  MakeSandbox(dir.path());
  const auto run = [&](const std::string& command) {
    return RunVelamap(ArgumentsIn(dir.path(), command));
  };
  fs::rename(dir / "images/1.png", dir / "images/swap.png");
  fs::rename(dir / "images/2.png", dir / "images/1.png");
  fs::rename(dir / "images/swap.png", dir / "images/2.png");
  fs::remove(dir / "images/4.png");
  EXPECT_EQ(run(kRerun).exit_code, 2);
  const ProgramRun anew = run(kRerun + " --import_anew 1");
  EXPECT_EQ(anew.exit_code, 0) << anew.err;
  for (const char* name : {"1.png", "2.png", "3.png"}) {
    EXPECT_EQ(ReadFileBytes(dir / "workspace/images" / name), ReadFileBytes(dir / "images" / name));
  }
  EXPECT_EQ(run(kRerun).exit_code, 0);

  const std::string clip =
      "marker_importer --image_path @/clip.avi --camera_path @/camera.yml "
      "--layout_path @/layout.yml --database_path @/clip.db "
      "--frame_output_path @/frames";
  EXPECT_EQ(run(clip).exit_code, 0);
  const ProgramRun fewer = run(clip + " --Video.frame_step 2 --import_anew 1");
  EXPECT_EQ(fewer.exit_code, 0) << fewer.err;
  EXPECT_THAT(fewer.out, HasSubstr("images_added: 2\n"));
  EXPECT_EQ(ListFolder(dir / "frames").size(), 2u);
}

}  // namespace
}  // namespace velamap
