// The table of bad input: the exit code, one line that names the fault, and no file that is new,
// changed or gone.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bad_input/sandbox.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;

std::vector<BadInput> AllCases() {
  std::vector<BadInput> cases;
  for (const auto& some : {OutputCases(), SourceCases(), InputCases()}) {
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
  const ProgramRun run = RunVelamap(ArgumentsIn(dir.path(), bad.command));
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

}  // namespace
}  // namespace velamap
