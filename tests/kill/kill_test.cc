// Ends the main job at random moments, and starts it twice at once. What a run leaves is what an
// undisturbed one leaves.
//
// VELAMAP_KILLS: how many runs are ended (8), VELAMAP_KILL_SEED: when (1).

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/bad_input/sandbox.h"
#include "tests/support/database_text.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using std::chrono::milliseconds;
using testing::ContainsRegex;
using Clock = std::chrono::steady_clock;

int Setting(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::stoi(text);
}

const std::string kOptions =
    " --camera_path @/camera.yml --layout_path @/layout.yml --workspace_path @/new ";

// The result, by the paths of its files. Logs and times are those of the run.
std::map<std::string, std::string> ResultIn(const fs::path& workspace) {
  std::map<std::string, std::string> result = ContentOf(workspace);
  for (const char* name : {"velamap.log", "colmap.log", "timing.json", "report.html"}) {
    if (result.count(name) > 0) result[name] = "of this run";
  }
  if (result.count("database.db") > 0) {
    result["database.db"] = DatabaseText(workspace / "database.db");
  }
  return result;
}

class Killed : public testing::Test {
 protected:
  Killed() {
    // Whatever the runs have started and left becomes our child.
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    MakeSandbox(dir_.path());
    fs::create_directory(dir_ / "tmp");
  }

  // Starts the program with its messages in the file "err" + `name`.
  pid_t Start(const std::string& command, const std::string& name) const {
    std::vector<std::string> words = ArgumentsIn(dir_.path(), command);
    words.insert(words.begin(), VELAMAP_PROGRAM);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string err = dir_ / ("err" + name), temporary = dir_ / "tmp";
    const pid_t pid = fork();
    if (pid != 0) return pid;
    setenv("TMPDIR", temporary.c_str(), 1);
    setenv("SOURCE_DATE_EPOCH", "1700000000", 1);  // the files of all runs have one date
    if (freopen(err.c_str(), "w", stderr) == nullptr) _exit(126);
    if (freopen("/dev/null", "w", stdout) == nullptr) _exit(126);
    execv(argv[0], argv.data());
    _exit(127);
  }

  static int WaitFor(pid_t pid) {
    int status = 0;
    waitpid(pid, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  std::string Messages(const std::string& name) const {
    return ReadFileBytes(dir_ / ("err" + name));
  }

  static void ExpectThatNoProcessIsLeft() {
    const auto end = Clock::now() + std::chrono::seconds(10);
    while (Clock::now() < end) {
      const pid_t pid = waitpid(-1, nullptr, WNOHANG);
      if (pid < 0) return;
      if (pid == 0) std::this_thread::sleep_for(milliseconds(2));
    }
    ADD_FAILURE() << "a process is still there";
  }

  // Names the files that differ: what is in them would fill pages.
  void ExpectSameResult(const std::map<std::string, std::string>& expected) const {
    const auto result = ResultIn(dir_ / "new");
    for (const auto& [name, content] : expected) {
      const auto found = result.find(name);
      EXPECT_NE(found, result.end()) << name << " is missing";
      EXPECT_TRUE(found == result.end() || found->second == content) << name << " differs";
    }
    for (const auto& [name, content] : result) EXPECT_EQ(expected.count(name), 1u) << name;
  }

  // Ends runs of the command at moments of its whole time, by one signal after the other.
  void ExpectThatRerunsDoNotDiffer(const std::string& command, int num_kills, unsigned seed) {
    const auto begin = Clock::now();
    ASSERT_EQ(WaitFor(Start(command, "")), 0) << Messages("");
    const std::chrono::duration<double> duration = Clock::now() - begin;
    const auto undisturbed = ResultIn(dir_ / "new");
    ASSERT_EQ(undisturbed.count("shape/shape.csv"), 1u);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> moment(0.0, duration.count());
    const std::vector<int> signals = {SIGKILL, SIGINT, SIGTERM};
    int num_killed = 0;
    for (int i = 0; i < num_kills; ++i) {
      const int signal = signals[static_cast<std::size_t>(i) % signals.size()];
      const std::chrono::duration<double> delay(moment(random));
      SCOPED_TRACE(fmt::format("signal {} after {:.3f} s", signal, delay.count()));
      fs::remove_all(dir_ / "new");
      const pid_t pid = Start(command, "");
      std::this_thread::sleep_for(delay);
      kill(pid, signal);
      const int status = WaitFor(pid);
      EXPECT_TRUE(status == -signal || status == 0) << status << ": " << Messages("");
      num_killed += status == -signal;
      ExpectThatNoProcessIsLeft();
      ASSERT_EQ(WaitFor(Start(command, "")), 0) << Messages("");
      ExpectSameResult(undisturbed);
      EXPECT_TRUE(fs::is_empty(dir_ / "tmp"));
      ExpectThatNoProcessIsLeft();
      if (HasFailure()) return;
    }
    EXPECT_GT(num_killed, 0);
  }

  TempDir dir_;
};

TEST_F(Killed, PhotographsGiveTheSameResultWhenRunAgain) {
  ExpectThatRerunsDoNotDiffer("automatic_reconstructor --image_path @/images" + kOptions,
                              Setting("VELAMAP_KILLS", 8) / 2,
                              static_cast<unsigned>(Setting("VELAMAP_KILL_SEED", 1)));
}

// Long enough for several transactions.
TEST_F(Killed, AVideoGivesTheSameResultWhenRunAgain) {
  WriteLongClip(60, dir_ / "long.avi");
  ExpectThatRerunsDoNotDiffer("automatic_reconstructor --image_path @/long.avi" + kOptions,
                              Setting("VELAMAP_KILLS", 8) / 2,
                              static_cast<unsigned>(Setting("VELAMAP_KILL_SEED", 1)) + 1);
}

// Whenever it is killed, the earlier import is there or the new one, with the frames of either.
TEST_F(Killed, AnImportAnewReplacesTheEarlierOneAsAWhole) {
  WriteLongClip(60, dir_ / "long.avi");
  const std::string command =
      "marker_importer --image_path @/long.avi --camera_path @/camera.yml --layout_path "
      "@/layout.yml --database_path @/new/database.db --frame_output_path @/new/frames ";
  const std::string other = command + "--Video.frame_step 3 --import_anew 1";
  fs::create_directory(dir_ / "new");
  ASSERT_EQ(WaitFor(Start(command, "")), 0) << Messages("");
  const auto earlier = ResultIn(dir_ / "new");
  fs::copy(dir_ / "new", dir_ / "earlier", fs::copy_options::recursive);
  const auto begin = Clock::now();
  ASSERT_EQ(WaitFor(Start(other, "")), 0) << Messages("");
  const std::chrono::duration<double> duration = Clock::now() - begin;
  const auto replaced = ResultIn(dir_ / "new");
  std::mt19937 random(static_cast<unsigned>(Setting("VELAMAP_KILL_SEED", 1)) + 2);
  std::uniform_real_distribution<double> moment(0.0, duration.count());
  for (int i = 0; i < Setting("VELAMAP_KILLS", 8) / 2; ++i) {
    fs::remove_all(dir_ / "new");
    fs::copy(dir_ / "earlier", dir_ / "new", fs::copy_options::recursive);
    const pid_t pid = Start(other, "");
    std::this_thread::sleep_for(std::chrono::duration<double>(moment(random)));
    kill(pid, SIGKILL);
    WaitFor(pid);
    const std::string database = DatabaseText(dir_ / "new/database.db");
    const bool is_earlier = database == earlier.at("database.db");
    EXPECT_TRUE(is_earlier || database == replaced.at("database.db"));
    // The next import settles what is left: one that adds nothing, or the same one again.
    const std::string next = i % 2 == 0   ? other
                             : is_earlier ? command
                                          : command + "--Video.frame_step 3";
    ASSERT_EQ(WaitFor(Start(next, "")), 0) << Messages("");
    ExpectSameResult(i % 2 != 0 && is_earlier ? earlier : replaced);
  }
}

// A COLMAP that never ends: a script, whose child has to go as well.
class Hanging : public Killed {
 protected:
  Hanging() {
    const fs::path program = dir_ / "colmap";
    WriteTextFile(program, "#!/bin/sh\n[ \"$2\" = -h ] && exec colmap \"$@\"\necho begun > '" +
                               (dir_ / "begun").string() + "'\nsleep 1000\necho ended\n");
    fs::permissions(program, fs::perms::owner_all);
  }

  const std::string command_ = "automatic_reconstructor --image_path @/images" + kOptions +
                               "--backend colmap --colmap_path @/colmap ";
};

TEST_F(Hanging, ColmapEndsWithUs) {
  for (const int signal : {SIGKILL, SIGINT, SIGTERM}) {
    fs::remove(dir_ / "begun");
    const pid_t pid = Start(command_, "");
    const auto end = Clock::now() + std::chrono::seconds(30);
    while (!fs::exists(dir_ / "begun") && Clock::now() < end) {
      std::this_thread::sleep_for(milliseconds(2));
    }
    ASSERT_TRUE(fs::exists(dir_ / "begun")) << Messages("");
    kill(pid, signal);
    EXPECT_EQ(WaitFor(pid), -signal);
    ExpectThatNoProcessIsLeft();
  }
}

TEST_F(Hanging, ColmapIsEndedAfterTheLimit) {
  EXPECT_EQ(WaitFor(Start(command_ + "--BundleAdjustment.time_limit 0.005", "")), 3);
  EXPECT_THAT(Messages(""),
              ContainsRegex("error: COLMAP had not ended after 0.005 minutes "
                            "\\(--BundleAdjustment.time_limit\\) and was ended: .*colmap.log"));
  ExpectThatNoProcessIsLeft();
  EXPECT_TRUE(fs::is_empty(dir_ / "tmp"));
}

// One of them works; the other says who does, and touches nothing.
// On a busy machine one run may end before the other looks for the lock; then both are good.
TEST_F(Killed, TwoRunsAtOnce) {
  const std::string command = "automatic_reconstructor --image_path @/images" + kOptions;
  ASSERT_EQ(WaitFor(Start(command, "")), 0) << Messages("");
  const auto undisturbed = ResultIn(dir_ / "new");
  int num_refused = 0;
  for (const bool is_new : {true, false}) {
    for (const int delay_ms : {0, 5, 50}) {
      if (is_new) fs::remove_all(dir_ / "new");
      const pid_t first = Start(command, "1");
      std::this_thread::sleep_for(milliseconds(delay_ms));
      const pid_t second = Start(command, "2");
      const int first_code = WaitFor(first), second_code = WaitFor(second);
      ExpectSameResult(undisturbed);
      if (first_code == 0 && second_code == 0) continue;
      ++num_refused;
      const bool is_first_good = first_code == 0;
      EXPECT_EQ(is_first_good ? second_code : first_code, 2);
      EXPECT_EQ(is_first_good ? first_code : second_code, 0);
      EXPECT_THAT(Messages(is_first_good ? "2" : "1"),
                  ContainsRegex(fmt::format(
                      "another velamap process is using it \\(since [0-9]+:[0-9]+, process {}\\);",
                      is_first_good ? first : second)));
    }
  }
  EXPECT_GT(num_refused, 0);
}

}  // namespace
}  // namespace velamap
