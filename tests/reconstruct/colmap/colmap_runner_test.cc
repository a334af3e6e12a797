// Small shell scripts stand in for COLMAP.

#include "reconstruct/colmap/colmap_runner.h"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "importer/base/error.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class ColmapRunnerTest : public testing::Test {
 protected:
  std::string Script(const std::string& body) {
    const fs::path path = dir_ / "fake_colmap";
    std::ofstream(path) << "#!/bin/sh\n" << body << "\n";
    fs::permissions(path, fs::perms::owner_all);
    return path;
  }

  std::string Log() const {
    std::ifstream in(log_path_);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  std::string ErrorOf(const std::string& program, const std::vector<std::string>& arguments = {}) {
    try {
      RunColmap(program, arguments, log_path_);
    } catch (const ExternalToolError& error) {
      return error.what();
    }
    return "no error";
  }

  TempDir dir_;
  std::string log_path_ = (dir_ / "folder") / "colmap.log";
};

TEST_F(ColmapRunnerTest, ArgumentsArriveAsTheyAre) {
  const std::string program = Script("for word in \"$@\"; do echo \"<$word>\"; done");
  const std::string output =
      RunColmap(program, {"two words", "$HOME; exit 1", "*", "", "'\""}, log_path_);
  EXPECT_EQ(output, "<two words>\n<$HOME; exit 1>\n<*>\n<>\n<'\">\n");
}

TEST_F(ColmapRunnerTest, BothStreamsReachTheLogWhichIsAppendedTo) {
  const std::string program = Script("echo out; echo err >&2");
  EXPECT_EQ(RunColmap(program, {"first"}, log_path_), "out\nerr\n");
  RunColmap(program, {"second"}, log_path_);
  EXPECT_EQ(Log(), "$ fake_colmap first\nout\nerr\n$ fake_colmap second\nout\nerr\n");
}

TEST_F(ColmapRunnerTest, TheLogNamesNoFolders) {
  const std::string program = Script("printf '%s' \"$1\"; sleep 0.1; echo /c; echo /no/end");
  RunColmap(program, {"/home/jo/a b", "/home/jo/c"}, log_path_);
  EXPECT_THAT(Log(), testing::Not(HasSubstr("/home")));
  EXPECT_THAT(Log(), testing::Not(HasSubstr("/no/")));
}

TEST_F(ColmapRunnerTest, ItsTemporaryFilesGoWithIt) {
  const std::string program = Script("echo $TMPDIR; touch $TMPDIR/colmap.INFO");
  std::string folder = RunColmap(program, {}, log_path_);
  folder.pop_back();
  EXPECT_NE(folder, fs::temp_directory_path().string());
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(ColmapRunnerTest, AProgramThatDoesNotEndIsEndedWithAllThatItHasStarted) {
  const ColmapLimit limit = {std::chrono::milliseconds(200), "--limit"};
  const auto begin = std::chrono::steady_clock::now();
  for (const char* body : {"sleep 100; echo", "sleep 100 & exec sleep 100",
                           "exec >/dev/null 2>&1; sleep 100", "trap '' TERM INT HUP; sleep 100"}) {
    const std::string program = Script(body);
    try {
      RunColmap(program, {}, log_path_, limit);
      ADD_FAILURE() << body;
    } catch (const ExternalToolError& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("not ended after 0.00333 minutes (--limit)"),
                                      HasSubstr(program), HasSubstr(log_path_)));
    }
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
  // What has ended is not waited for, though a process that it has left holds its output.
  EXPECT_EQ(RunColmap(Script("sleep 100 & echo done"), {}, log_path_), "done\n");
}

TEST_F(ColmapRunnerTest, EndlessOutputIsEnded) {
  EXPECT_THAT(ErrorOf(Script("exec yes")), HasSubstr("wrote more than"));
}

TEST_F(ColmapRunnerTest, LongOutputIsWhole) {
  const std::string program = Script(
      "i=0; while [ $i -lt 20000 ]; do echo 123456789; i=$((i+1)); "
      "done");
  EXPECT_EQ(RunColmap(program, {}, log_path_).size(), 200000u);
}

TEST_F(ColmapRunnerTest, RunsWithoutADisplayOrInput) {
  const std::string program = Script("echo $QT_QPA_PLATFORM; cat; echo $HOME");
  const char* home = std::getenv("HOME");
  EXPECT_EQ(RunColmap(program, {}, log_path_),
            std::string("offscreen\n") + (home != nullptr ? home : "") + "\n");
}

TEST_F(ColmapRunnerTest, RunsWhereOurOwnStdinIsClosed) {
  const std::string program = Script("cat; echo $1");
  EXPECT_EXIT(
      {
        close(STDIN_FILENO);
        std::exit(RunColmap(program, {"here"}, log_path_) == "here\n" ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

TEST_F(ColmapRunnerTest, FailureNamesStatusCommandReasonAndLog) {
  const std::string program = Script("echo start; echo 'ERROR: no such model'; echo bye; exit 3");
  EXPECT_THAT(ErrorOf(program, {"bundle_adjuster", "--input_path", "my model"}),
              AllOf(HasSubstr("exited with status 3"),
                    HasSubstr(program + " bundle_adjuster --input_path 'my model'"),
                    HasSubstr("it wrote: ERROR: no such model"), HasSubstr(log_path_)));
  EXPECT_THAT(Log(), HasSubstr("(exited with status 3)"));
}

TEST_F(ColmapRunnerTest, FailureWithoutALogNamesNone) {
  log_path_ = kNoLog;
  EXPECT_THAT(ErrorOf(Script("exit 127")),
              AllOf(HasSubstr("exited with status 127"), testing::Not(HasSubstr("log"))));
}

TEST_F(ColmapRunnerTest, FailureWithoutASignQuotesTheLastLine) {
  EXPECT_THAT(ErrorOf(Script("echo one; echo two; echo; exit 1")), HasSubstr("it wrote last: two"));
  EXPECT_THAT(ErrorOf(Script("exit 1")), HasSubstr("it wrote nothing"));
}

TEST_F(ColmapRunnerTest, QuotesTheBeginOfALongLine) {
  const std::string error = ErrorOf(Script("head -c 5000000 /dev/zero | tr '\\0' x; exit 1"));
  EXPECT_THAT(error, HasSubstr("it wrote last: xxx"));
  EXPECT_LT(error.size(), 2000u);
  EXPECT_GT(Log().size(), 5000000u);
}

TEST_F(ColmapRunnerTest, DeathBySignalSaysSo) {
  EXPECT_THAT(ErrorOf(Script("kill -9 $$")),
              AllOf(HasSubstr("killed by signal 9 (Killed)"), HasSubstr("memory")));
  EXPECT_THAT(ErrorOf(Script("kill -6 $$")), HasSubstr("killed by signal 6 (Aborted)"));
}

TEST_F(ColmapRunnerTest, MissingProgramSaysHowToGetIt) {
  for (const std::string program : {"velamap-no-such-program", "/no/such/colmap"}) {
    EXPECT_THAT(ErrorOf(program), AllOf(HasSubstr(program), HasSubstr("apt install colmap"),
                                        HasSubstr("--colmap_path")));
  }
  std::ofstream(dir_ / "text") << "not a program";
  EXPECT_THAT(ErrorOf(dir_ / "text"), HasSubstr("Permission denied"));
}

TEST_F(ColmapRunnerTest, UnwritableLogIsAnInputError) {
  std::ofstream(dir_ / "folder") << "a file";
  EXPECT_THROW(RunColmap(Script("true"), {}, log_path_), InputError);
}

TEST_F(ColmapRunnerTest, OptionsAreProbedByWholeNameOncePerCommand) {
  const std::string program = Script("echo run >> " + (dir_ / "runs").string() +
                                     "; [ \"$2\" = -h ] && echo '  --A.max_number arg (=1)'");
  EXPECT_TRUE(ColmapHasOption(program, "bundle_adjuster", "A.max_number"));
  EXPECT_FALSE(ColmapHasOption(program, "bundle_adjuster", "A.max"));
  EXPECT_FALSE(ColmapHasOption(program, "bundle_adjuster", "max_number"));
  std::ifstream runs(dir_ / "runs");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(runs), {}), "run\n");
}

TEST_F(ColmapRunnerTest, ProbingAMissingProgramThrows) {
  EXPECT_THROW(ColmapHasOption("velamap-no-such-program", "bundle_adjuster", "x"),
               ExternalToolError);
}

}  // namespace
}  // namespace velamap
